#include "video_encoder.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libswscale/swscale.h>
}

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "apriltrack/base/error.h"

namespace apriltrack {
namespace {

constexpr int kSilence = AV_LOG_TRACE;  // added to a message's level: none is shown
constexpr int kLargestTimeScale = 1'001'000;
constexpr double kKeyFrameInterval_s = 2.0;  // what a viewer who jumps about waits for at most
constexpr int kRowPadding = 64;
// Constant quality: 18 can hardly be told from the original, 28 is coarse. Of 360 blurred frames of 640 x
// 480, 23 (what x264 takes by itself) makes 2.3 MB and 20 makes 3.5 MB, at 10 ms a frame.
constexpr const char* kQuality = "23";
constexpr const char* kPreset = "veryfast";

const AVCodec& find_encoder(std::span<const char* const> names, const std::string& file) {
  for (const char* name : names)
    if (const AVCodec* encoder = avcodec_find_encoder_by_name(name)) return *encoder;
  std::string list;
  for (const char* name : names) list += fmt::format("{}{}", list.empty() ? "" : ", ", name);
  throw io_error(
      file, fmt::format("cannot be written: this FFmpeg has no H.264 encoder (looked for {}); install an "
                        "FFmpeg built with one of them, as Debian's is, or leave the video out",
                        list));
}

}  // namespace

void VideoEncoder::Deleter::operator()(AVCodecContext* context) const {
  avcodec_free_context(&context);
}
void VideoEncoder::Deleter::operator()(AVFrame* frame) const {
  av_frame_free(&frame);
}
void VideoEncoder::Deleter::operator()(AVPacket* packet) const {
  av_packet_free(&packet);
}
void VideoEncoder::Deleter::operator()(SwsContext* context) const {
  sws_freeContext(context);
}

VideoEncoder::VideoEncoder(const std::filesystem::path& file, const std::string& name, const Format& format,
                           std::span<const char* const> encoders)
    : name_(name),
      file_(open_output(file, name)),
      frame_(av_frame_alloc()),
      packet_(av_packet_alloc()),
      padded_(format.height + 1, format.width + kRowPadding, CV_8UC3) {
  open_codec(find_encoder(encoders, name), format);
  stream_ = avformat_new_stream(file_.get(), nullptr);
  stream_->time_base = codec_->time_base;
  stream_->avg_frame_rate = codec_->framerate;
  check_written(avcodec_parameters_from_context(stream_->codecpar, codec_.get()), name_);
  check_written(avformat_write_header(file_.get(), nullptr), name_);
  frame_->format = codec_->pix_fmt;
  frame_->width = format.width;
  frame_->height = format.height;
  check_written(av_frame_get_buffer(frame_.get(), 0), name_);
  converter_.reset(sws_getContext(format.width, format.height, AV_PIX_FMT_BGR24, format.width, format.height,
                                  codec_->pix_fmt, SWS_BICUBIC | SWS_ACCURATE_RND | SWS_FULL_CHR_H_INP,
                                  nullptr, nullptr, nullptr));
  if (!converter_) throw io_error(name_, "cannot be written: FFmpeg cannot convert its colours");
}

void VideoEncoder::open_codec(const AVCodec& encoder, const Format& format) {
  codec_.reset(avcodec_alloc_context3(&encoder));
  codec_->log_level_offset = kSilence;
  codec_->width = format.width;
  codec_->height = format.height;
  codec_->framerate = av_d2q(format.frames_per_s, kLargestTimeScale);
  codec_->time_base = av_inv_q(codec_->framerate);
  codec_->gop_size = std::max(1, static_cast<int>(std::lround(kKeyFrameInterval_s * format.frames_per_s)));
  codec_->pix_fmt = AV_PIX_FMT_YUV420P;
  // What the converter makes by default. Said, because players guess otherwise, by the size of the picture.
  codec_->colorspace = AVCOL_SPC_SMPTE170M;
  codec_->color_range = AVCOL_RANGE_MPEG;
  codec_->thread_count = 1;                      // the same file on every machine
  codec_->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;  // as MP4 wants it
  AVDictionary* options = nullptr;               // those that the encoder does not know are left in it
  av_dict_set(&options, "preset", kPreset, 0);
  av_dict_set(&options, "crf", kQuality, 0);
  const int opened = avcodec_open2(codec_.get(), &encoder, &options);
  av_dict_free(&options);
  check_written(opened, name_);
}

void VideoEncoder::add(const cv::Mat& bgr) {
  bgr.copyTo(padded_(cv::Rect(0, 0, bgr.cols, bgr.rows)));
  check_written(av_frame_make_writable(frame_.get()), name_);
  const std::uint8_t* const rows[] = {padded_.data};
  const int stride[] = {static_cast<int>(padded_.step[0])};
  sws_scale(converter_.get(), rows, stride, 0, frame_->height, frame_->data, frame_->linesize);
  frame_->pts = num_frames_++;
  encode(frame_.get());
}

void VideoEncoder::encode(const AVFrame* frame) {
  check_written(avcodec_send_frame(codec_.get(), frame), name_);
  for (;;) {
    const int received = avcodec_receive_packet(codec_.get(), packet_.get());
    if (received == AVERROR(EAGAIN) || received == AVERROR_EOF) return;
    check_written(received, name_);
    packet_->stream_index = stream_->index;
    av_packet_rescale_ts(packet_.get(), codec_->time_base, stream_->time_base);
    check_written(av_interleaved_write_frame(file_.get(), packet_.get()), name_);
  }
}

void VideoEncoder::finish() {
  encode(nullptr);
  finish_output(std::move(file_), name_);
}

}  // namespace apriltrack
