#include "video_decoder.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/common.h>
#include <libavutil/display.h>
#include <libavutil/parseutils.h>
}

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core.hpp>
#include <string_view>

#include "apriltrack/base/error.h"
#include "apriltrack/image/opencv_bridge.h"
#include "gray_pixels.h"
#include "pipe_input.h"

namespace apriltrack {
namespace {

/// So often in a row may the decoder fail without having been given anything new.
constexpr int kMaxIdleErrors = 100;
/// Of a live stream's beginning: the first frame is wanted soon.
constexpr std::int64_t kPipeAnalysis_us = 100'000;
constexpr const char* kPipeAdvice =
    "; a pipe cannot be gone back in, as some containers (MP4) and bags need: send Matroska, MPEG-TS or JPEG "
    "pictures, as `ffmpeg -i film.mp4 -c copy -f matroska - | apriltrack track - ...` does";
constexpr AVRational kNanoseconds = {1, kNsPerSecond};

std::string reason(int code) {
  std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
  av_strerror(code, text.data(), text.size());
  return text.data();
}

/// The stream's display matrix, nullptr where it has none. FFmpeg 6.1 moved it from the stream to the codec's
/// parameters.
const std::uint8_t* display_matrix(const AVStream& stream) {
#if LIBAVCODEC_VERSION_INT >= AV_VERSION_INT(60, 31, 100)
  const AVCodecParameters& codec = *stream.codecpar;
  const AVPacketSideData* found =
      av_packet_side_data_get(codec.coded_side_data, codec.nb_coded_side_data, AV_PKT_DATA_DISPLAYMATRIX);
  return found ? found->data : nullptr;
#else
  return av_stream_get_side_data(&stream, AV_PKT_DATA_DISPLAYMATRIX, nullptr);
#endif
}

/// Phones store the sensor's picture and say how to turn it.
int quarter_turns_anticlockwise(const AVStream& stream) {
  const std::uint8_t* data = display_matrix(stream);
  if (!data) return 0;
  const double angle_deg = av_display_rotation_get(reinterpret_cast<const std::int32_t*>(data));
  if (!std::isfinite(angle_deg)) return 0;
  return ((static_cast<int>(std::lround(angle_deg / 90.0)) % 4) + 4) % 4;
}

GrayImage turned(const GrayImage& image, int turns) {
  if (turns == 0) return image;
  constexpr std::array kRotations = {cv::ROTATE_90_COUNTERCLOCKWISE, cv::ROTATE_180, cv::ROTATE_90_CLOCKWISE};
  cv::Mat upright;
  cv::rotate(mat_of(image.view()), upright, kRotations[static_cast<std::size_t>(turns - 1)]);
  return copy_of(upright);
}

/// Of QuickTime and MP4 the header lists every frame; those that an edit list cuts out are in its count, but
/// not in FFmpeg's index, and are not read.
std::optional<std::size_t> count_in_header(const AVFormatContext& file, const AVStream& stream) {
  if (stream.nb_frames <= 0) return std::nullopt;
  const auto count = static_cast<std::size_t>(stream.nb_frames);
  const bool has_edit_lists = std::string_view(file.iformat->name).find("mp4") != std::string_view::npos;
  const int num_indexed = has_edit_lists ? avformat_index_get_entries_count(&stream) : 0;
  return num_indexed > 0 ? std::min(count, static_cast<std::size_t>(num_indexed)) : count;
}

/// Matroska holds the duration of the whole file, whose sound may go on longer, and those of its streams as
/// text. What FFmpeg estimates from a file's size says nothing of what is missing.
std::optional<double> duration_in_header(const AVFormatContext& file, const AVStream& stream) {
  if (file.duration_estimation_method != AVFMT_DURATION_FROM_STREAM) return std::nullopt;
  if (stream.duration > 0) return static_cast<double>(stream.duration) * av_q2d(stream.time_base);
  std::int64_t duration_us = 0;
  const AVDictionaryEntry* text = av_dict_get(stream.metadata, "DURATION", nullptr, 0);
  if (text != nullptr && av_parse_time(&duration_us, text->value, 1) >= 0)
    return 1e-6 * static_cast<double>(duration_us);
  if (file.nb_streams != 1 || file.duration <= 0) return std::nullopt;
  return static_cast<double>(file.duration) / AV_TIME_BASE;
}

}  // namespace

void VideoDecoder::Deleter::operator()(AVFormatContext* context) const {
  avformat_close_input(&context);
}
void VideoDecoder::Deleter::operator()(AVIOContext* context) const {
  av_freep(&context->buffer);
  avio_context_free(&context);
}
void VideoDecoder::Deleter::operator()(AVCodecContext* context) const {
  avcodec_free_context(&context);
}
void VideoDecoder::Deleter::operator()(AVFrame* frame) const {
  av_frame_free(&frame);
}
void VideoDecoder::Deleter::operator()(AVPacket* packet) const {
  av_packet_free(&packet);
}

VideoDecoder::VideoDecoder(const std::string& path)
    : bytes_(path), frame_(av_frame_alloc()), packet_(av_packet_alloc()) {
  open_file();
  open_stream();
}

void VideoDecoder::open_file() {
  const std::string& path = bytes_.name();
  const char* const advice = bytes_.is_pipe() ? kPipeAdvice : "";
  constexpr int kBuffer = 1 << 16;
  reader_.reset(avio_alloc_context(static_cast<unsigned char*>(av_malloc(kBuffer)), kBuffer, 0, &bytes_,
                                   VideoBytes::read, nullptr, bytes_.is_pipe() ? nullptr : VideoBytes::seek));
  AVFormatContext* file = avformat_alloc_context();
  file->pb = reader_.get();
  if (bytes_.is_pipe()) file->max_analyze_duration = kPipeAnalysis_us;
  AVDictionary* options = nullptr;
  av_dict_set(&options, "protocol_whitelist", "none", 0);  // what a file names is not opened
  // The name's ending tells FFmpeg of streams without a mark of their own.
  const int opened =
      avformat_open_input(&file, path.c_str(), nullptr, &options);  // which frees it if it fails
  av_dict_free(&options);
  if (opened < 0)
    throw io_error(
        path, fmt::format("is neither an image nor a video that can be read: {}{}", reason(opened), advice));
  file_.reset(file);
  if (bytes_.is_pipe() && std::string_view(file->iformat->name) == "tty")
    throw io_error(path, fmt::format("is a text, neither an image nor a video{}", advice));
  const int probed = avformat_find_stream_info(file, nullptr);
  if (probed < 0)
    throw io_error(path, fmt::format("its streams cannot be read: {}{}", reason(probed), advice));
}

void VideoDecoder::open_stream() {
  const std::string& path = bytes_.name();
  const AVCodec* decoder = nullptr;
  const int index = av_find_best_stream(file_.get(), AVMEDIA_TYPE_VIDEO, -1, -1, &decoder, 0);
  if (index < 0)
    throw io_error(path, fmt::format("holds no video that can be decoded: {}{}", reason(index),
                                     bytes_.is_pipe() ? kPipeAdvice : ""));
  for (unsigned i = 0; i < file_->nb_streams; ++i) file_->streams[i]->discard = AVDISCARD_ALL;
  stream_ = file_->streams[index];
  stream_->discard = AVDISCARD_DEFAULT;
  num_promised_ = count_in_header(*file_, *stream_);
  promised_s_ = duration_in_header(*file_, *stream_);
  turns_ = quarter_turns_anticlockwise(*stream_);
  // Of a pipe it may not be known yet, and what FFmpeg says later may be the time of a later frame.
  if (stream_->start_time != AV_NOPTS_VALUE) start_ = stream_->start_time;
  codec_.reset(avcodec_alloc_context3(decoder));
  avcodec_parameters_to_context(codec_.get(), stream_->codecpar);
  codec_->pkt_timebase = stream_->time_base;
  const int opened = avcodec_open2(codec_.get(), decoder, nullptr);
  if (opened < 0) throw io_error(path, fmt::format("its video cannot be decoded: {}", reason(opened)));
}

std::optional<VideoDecoder::Decoded> VideoDecoder::advance() {
  for (;;) {
    const int received = avcodec_receive_frame(codec_.get(), frame_.get());
    if (received == 0) {
      num_idle_errors_ = 0;
      const bool is_damaged = (frame_->flags & AV_FRAME_FLAG_CORRUPT) != 0 || frame_->decode_error_flags != 0;
      return Decoded{time_of(frame_->best_effort_timestamp), is_damaged ? "the data is damaged" : ""};
    }
    if (received == AVERROR_EOF) return std::nullopt;
    if (received != AVERROR(EAGAIN)) {
      if (++num_idle_errors_ > kMaxIdleErrors) return std::nullopt;
      return Decoded{std::nullopt, fmt::format("cannot be decoded: {}", reason(received))};
    }
    if (is_draining_) return std::nullopt;  // it asks for more, and there is no more
    if (auto failed = feed()) return failed;
  }
}

std::optional<VideoDecoder::Decoded> VideoDecoder::feed() {
  int got = 0;
  do {
    av_packet_unref(packet_.get());
    got = av_read_frame(file_.get(), packet_.get());
  } while (got >= 0 && packet_->stream_index != stream_->index);
  if (got < 0) {
    const bool broke_off = got != AVERROR_EOF && !is_draining_;
    is_draining_ = true;
    avcodec_send_packet(codec_.get(), nullptr);
    if (broke_off)
      return Decoded{std::nullopt, fmt::format("the file breaks off: {}{}", reason(got),
                                               bytes_.is_pipe() && num_whole_ == 0 ? kPipeAdvice : "")};
    return std::nullopt;
  }
  if ((packet_->flags & AV_PKT_FLAG_CORRUPT) == 0) {
    ++num_whole_;
    if (packet_->pts != AV_NOPTS_VALUE)
      shown_s_ = std::max(shown_s_,
                          static_cast<double>(packet_->pts + std::max<std::int64_t>(0, packet_->duration)) *
                              av_q2d(stream_->time_base));
  }
  num_idle_errors_ = 0;
  const int sent = avcodec_send_packet(codec_.get(), packet_.get());
  if (sent < 0) return Decoded{time_of(packet_->pts), fmt::format("cannot be decoded: {}", reason(sent))};
  return std::nullopt;
}

std::optional<Timestamp> VideoDecoder::time_of(std::int64_t stream_time) {
  if (stream_time == AV_NOPTS_VALUE) return std::nullopt;
  if (!start_) start_ = stream_time;
  return Timestamp{av_rescale_q(av_sat_sub64(stream_time, *start_), stream_->time_base, kNanoseconds)};
}

GrayImage VideoDecoder::picture() {
  const GrayImage image = converter_.convert(*frame_);
  return image.is_empty() ? image : turned(image, turns_);
}

std::optional<std::size_t> VideoDecoder::num_frames() const {
  if (stream_->nb_frames > 0) return static_cast<std::size_t>(stream_->nb_frames);
  const double rate_hz = av_q2d(stream_->avg_frame_rate);
  const double count = static_cast<double>(file_->duration) / AV_TIME_BASE * rate_hz;
  if (file_->duration <= 0 || !std::isfinite(count) || count < 1.0) return std::nullopt;
  return static_cast<std::size_t>(std::lround(count));
}

double VideoDecoder::rate_hz() const {
  const double rate_hz = av_q2d(stream_->avg_frame_rate);
  return std::isfinite(rate_hz) && rate_hz > 0.0 ? rate_hz : 0.0;
}

bool VideoDecoder::has_times() const {
  // Of pictures one after the other ("jpeg_pipe") they are a rate that nobody stated.
  const bool are_pictures = std::string_view(file_->iformat->name).find("pipe") != std::string_view::npos;
  return !are_pictures && (file_->iformat->flags & AVFMT_NOTIMESTAMPS) == 0;
}

}  // namespace apriltrack
