#include "video_files.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/display.h>
#include <libavutil/opt.h>
}

#include <algorithm>
#include <cmath>
#include <cstring>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

namespace apriltrack::test {
namespace {

constexpr AVRational kTick = {1, static_cast<int>(kTicksPerSecond)};

void require(bool is_true, const char* what) {
  if (!is_true) throw std::runtime_error(std::string("test video: ") + what);
}

/// A container with one video stream.
class Container {
 public:
  explicit Container(const std::filesystem::path& path) {
    require(avformat_alloc_output_context2(&file_, nullptr, nullptr, path.c_str()) >= 0, "unknown container");
    require(avio_open(&file_->pb, path.c_str(), AVIO_FLAG_WRITE) >= 0, "cannot be written");
    stream_ = avformat_new_stream(file_, nullptr);
    stream_->time_base = kTick;
  }
  Container(const Container&) = delete;
  Container& operator=(const Container&) = delete;
  ~Container() {
    avio_closep(&file_->pb);
    avformat_free_context(file_);
  }

  AVStream& stream() { return *stream_; }
  bool wants_global_header() const { return (file_->oformat->flags & AVFMT_GLOBALHEADER) != 0; }

  void begin(int turn_clockwise_deg) {
    if (turn_clockwise_deg != 0) {
      av_display_rotation_set(reinterpret_cast<std::int32_t*>(new_display_matrix()), turn_clockwise_deg);
    }
    require(avformat_write_header(file_, nullptr) >= 0, "header");
  }
  void write(AVPacket& packet) {
    packet.stream_index = 0;
    av_packet_rescale_ts(&packet, kTick, stream_->time_base);
    require(av_interleaved_write_frame(file_, &packet) >= 0, "packet");
  }
  void end() { require(av_write_trailer(file_) >= 0, "trailer"); }

 private:
  std::uint8_t* new_display_matrix() {
    constexpr std::size_t kSize = 9 * sizeof(std::int32_t);
#if LIBAVCODEC_VERSION_INT >= AV_VERSION_INT(60, 31, 100)  // FFmpeg 6.1
    AVCodecParameters& codec = *stream_->codecpar;
    return av_packet_side_data_new(&codec.coded_side_data, &codec.nb_coded_side_data,
                                   AV_PKT_DATA_DISPLAYMATRIX, kSize, 0)
        ->data;
#else
    return av_stream_new_side_data(stream_, AV_PKT_DATA_DISPLAYMATRIX, kSize);
#endif
  }

  AVFormatContext* file_ = nullptr;
  AVStream* stream_ = nullptr;
};

std::vector<unsigned char> jpeg_of(const GrayImage& picture) {
  const cv::Mat view(picture.height(), picture.width(), CV_8UC1, const_cast<std::uint8_t*>(picture.row(0)));
  std::vector<unsigned char> bytes;
  cv::imencode(".jpg", view, bytes, {cv::IMWRITE_JPEG_QUALITY, 98});
  return bytes;
}

void fill(AVFrame& frame, const GrayImage& picture) {
  require(av_frame_make_writable(&frame) >= 0, "frame");
  for (int y = 0; y < frame.height; ++y) {
    for (int x = 0; x < frame.width; ++x) {
      frame.data[0][y * frame.linesize[0] + x] =
          static_cast<std::uint8_t>(std::lround(16.0 + picture(x, y) * 219.0 / 255.0));
    }
  }
  for (int plane : {1, 2})
    std::memset(frame.data[plane], 128, static_cast<std::size_t>(frame.linesize[plane] * frame.height / 2));
}

}  // namespace

void write_mjpeg_video(const std::filesystem::path& path, const VideoPlan& plan) {
  Container container(path);
  AVCodecParameters& parameters = *container.stream().codecpar;
  parameters.codec_type = AVMEDIA_TYPE_VIDEO;
  parameters.codec_id = AV_CODEC_ID_MJPEG;
  parameters.width = plan.pictures.empty() ? 64 : plan.pictures.front().width();
  parameters.height = plan.pictures.empty() ? 48 : plan.pictures.front().height();
  container.begin(plan.turn_clockwise_deg);
  for (std::size_t i = 0; i < plan.pictures.size(); ++i) {
    std::vector<unsigned char> bytes = jpeg_of(plan.pictures[i]);
    if (static_cast<int>(i) == plan.damaged_picture)
      std::ranges::fill(bytes, static_cast<unsigned char>(0x11));
    AVPacket* packet = av_packet_alloc();
    av_new_packet(packet, static_cast<int>(bytes.size()));
    std::ranges::copy(bytes, packet->data);
    packet->pts = packet->dts = plan.times_ticks[i];
    packet->flags |= AV_PKT_FLAG_KEY;
    // No step tells a lone picture's duration, and FFmpeg 7 reads no picture that lasts for none.
    if (plan.pictures.size() == 1) packet->duration = kTicksPerSecond / 30;
    container.write(*packet);
    av_packet_free(&packet);
  }
  container.end();
}

namespace {

/// set_up: what is particular to the codec.
template <class SetUp>
void write_encoded_video(const std::filesystem::path& path, const VideoPlan& plan, AVCodecID codec,
                         const SetUp& set_up) {
  Container container(path);
  AVCodecContext* encoder = avcodec_alloc_context3(avcodec_find_encoder(codec));
  encoder->width = plan.pictures.front().width();
  encoder->height = plan.pictures.front().height();
  encoder->pix_fmt = AV_PIX_FMT_YUV420P;
  // MPEG-4 holds times in ticks of at most 16 bits a second.
  encoder->time_base = {1, 30000};
  encoder->gop_size = 12;
  if (container.wants_global_header()) encoder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
  set_up(*encoder);
  container.stream().avg_frame_rate = encoder->framerate;
  require(avcodec_open2(encoder, nullptr, nullptr) >= 0, "encoder");
  avcodec_parameters_from_context(container.stream().codecpar, encoder);
  container.begin(plan.turn_clockwise_deg);

  AVFrame* frame = av_frame_alloc();
  frame->format = encoder->pix_fmt;
  frame->width = encoder->width;
  frame->height = encoder->height;
  av_frame_get_buffer(frame, 0);
  AVPacket* packet = av_packet_alloc();
  for (std::size_t i = 0; i <= plan.pictures.size(); ++i) {
    const bool is_end = i == plan.pictures.size();
    if (!is_end) {
      fill(*frame, plan.pictures[i]);
      frame->pts = av_rescale_q(plan.times_ticks[i], kTick, encoder->time_base);
    }
    avcodec_send_frame(encoder, is_end ? nullptr : frame);
    while (avcodec_receive_packet(encoder, packet) >= 0) {
      av_packet_rescale_ts(packet, encoder->time_base, kTick);
      container.write(*packet);
    }
  }
  container.end();
  av_packet_free(&packet);
  av_frame_free(&frame);
  avcodec_free_context(&encoder);
}

}  // namespace

void write_b_frame_video(const std::filesystem::path& path, const VideoPlan& plan) {
  write_encoded_video(path, plan, AV_CODEC_ID_MPEG4, [](AVCodecContext& encoder) {
    encoder.max_b_frames = 2;
    encoder.flags |= AV_CODEC_FLAG_QSCALE;
    encoder.global_quality = 2 * FF_QP2LAMBDA;
    av_opt_set_int(encoder.priv_data, "b_strategy", 0, 0);  // always two, whatever the pictures
  });
}

bool can_write_h264() {
  return avcodec_find_encoder(AV_CODEC_ID_H264) != nullptr;
}

void write_live_h264_video(const std::filesystem::path& path, const VideoPlan& plan) {
  av_log_set_level(AV_LOG_WARNING);  // it tells its statistics
  write_encoded_video(path, plan, AV_CODEC_ID_H264, [](AVCodecContext& encoder) {
    encoder.max_b_frames = 0;
    encoder.framerate = {30, 1};  // which the header tells then
  });
}

}  // namespace apriltrack::test
