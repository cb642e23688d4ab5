#include "decoded_video.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/pixdesc.h>
}

#include <memory>
#include <stdexcept>

#include "apriltrack/io/atomic_file.h"

namespace apriltrack::test {
namespace {

void expect_from_ffmpeg(bool condition, const char* what) {
  if (!condition) throw std::runtime_error(what);
}

struct Closer {
  void operator()(AVFormatContext* file) const { avformat_close_input(&file); }
  void operator()(AVCodecContext* codec) const { avcodec_free_context(&codec); }
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
};
template <class T>
using Held = std::unique_ptr<T, Closer>;

cv::Mat plane(const AVFrame& frame, int index, int width, int height) {
  return cv::Mat(height, width, CV_8UC1, frame.data[index], static_cast<std::size_t>(frame.linesize[index]))
      .clone();
}

cv::Mat bgr_by_bt601(const cv::Mat& luma, const cv::Mat& cb, const cv::Mat& cr) {
  cv::Mat bgr(luma.size(), CV_8UC3);
  for (int y = 0; y < luma.rows; ++y) {
    for (int x = 0; x < luma.cols; ++x) {
      const double light = 255.0 / 219.0 * (luma.at<std::uint8_t>(y, x) - 16.0);
      const double blue = 255.0 / 224.0 * (cb.at<std::uint8_t>(y / 2, x / 2) - 128.0);
      const double red = 255.0 / 224.0 * (cr.at<std::uint8_t>(y / 2, x / 2) - 128.0);
      bgr.at<cv::Vec3b>(y, x) = {cv::saturate_cast<std::uint8_t>(light + 1.772 * blue),
                                 cv::saturate_cast<std::uint8_t>(light - 0.714136 * red - 0.344136 * blue),
                                 cv::saturate_cast<std::uint8_t>(light + 1.402 * red)};
    }
  }
  return bgr;
}

DecodedFrame decoded(const AVFrame& frame, AVRational time_base) {
  expect_from_ffmpeg(frame.format == AV_PIX_FMT_YUV420P, "not yuv420p");
  expect_from_ffmpeg(frame.colorspace == AVCOL_SPC_SMPTE170M && frame.color_range == AVCOL_RANGE_MPEG,
                     "no word of BT.601");
  const cv::Mat luma = plane(frame, 0, frame.width, frame.height);
  const cv::Mat cb = plane(frame, 1, frame.width / 2, frame.height / 2);
  const cv::Mat cr = plane(frame, 2, frame.width / 2, frame.height / 2);
  return {static_cast<double>(frame.best_effort_timestamp) * av_q2d(time_base), luma,
          bgr_by_bt601(luma, cb, cr)};
}

}  // namespace

DecodedVideo decode_video(const std::filesystem::path& path) {
  AVFormatContext* opened = nullptr;
  expect_from_ffmpeg(avformat_open_input(&opened, path.c_str(), nullptr, nullptr) == 0, "cannot be opened");
  const Held<AVFormatContext> file(opened);
  expect_from_ffmpeg(avformat_find_stream_info(file.get(), nullptr) >= 0 && file->nb_streams == 1,
                     "not one stream");
  const AVStream& stream = *file->streams[0];
  const AVCodec* decoder = avcodec_find_decoder(stream.codecpar->codec_id);
  const Held<AVCodecContext> codec(avcodec_alloc_context3(decoder));
  expect_from_ffmpeg(avcodec_parameters_to_context(codec.get(), stream.codecpar) >= 0, "no parameters");
  expect_from_ffmpeg(avcodec_open2(codec.get(), decoder, nullptr) == 0, "no decoder");
  DecodedVideo video{avcodec_get_name(stream.codecpar->codec_id),
                     av_get_pix_fmt_name(static_cast<AVPixelFormat>(stream.codecpar->format)),
                     static_cast<double>(stream.duration) * av_q2d(stream.time_base),
                     {}};
  const Held<AVFrame> frame(av_frame_alloc());
  const Held<AVPacket> packet(av_packet_alloc());
  bool has_more = true;
  while (has_more) {
    has_more = av_read_frame(file.get(), packet.get()) >= 0;
    expect_from_ffmpeg(avcodec_send_packet(codec.get(), has_more ? packet.get() : nullptr) == 0,
                       "cannot be decoded");
    av_packet_unref(packet.get());
    while (avcodec_receive_frame(codec.get(), frame.get()) == 0)
      video.frames.push_back(decoded(*frame, stream.time_base));
  }
  return video;
}

std::vector<std::string> box_names(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  std::vector<std::string> names;
  for (std::size_t at = 0; at + 8 <= bytes.size();) {
    std::size_t length = 0;
    for (std::size_t i = 0; i < 4; ++i) length = length << 8 | static_cast<std::uint8_t>(bytes[at + i]);
    names.push_back(bytes.substr(at + 4, 4));
    expect_from_ffmpeg(length >= 8, "a box that is longer than 4 GB, or broken");
    at += length;
  }
  return names;
}

}  // namespace apriltrack::test
