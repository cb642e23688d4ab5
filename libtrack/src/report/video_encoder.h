#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>
#include <span>
#include <string>

#include "mp4_file.h"

struct AVCodec;
struct AVCodecContext;
struct AVFrame;
struct AVPacket;
struct AVStream;
struct SwsContext;

namespace apriltrack {

/// FFmpeg's names of H.264 encoders, best first.
inline constexpr const char* kH264Encoders[] = {"libx264", "libopenh264"};

/// Encodes pictures as H.264 into an MP4 file.
///
/// FFmpeg itself and not cv::VideoWriter, which does not say when a frame could not be written (a full disk),
/// and lets nobody choose the quality.
class VideoEncoder {
 public:
  struct Format {
    int width = 0;  ///< Both even: yuv420p has one colour for 2 x 2 pixels.
    int height = 0;
    double frames_per_s = 0.0;
  };
  /// name: of the file in messages. encoders: tried in turn. Throws Error(kIo).
  VideoEncoder(const std::filesystem::path& file, const std::string& name, const Format& format,
               std::span<const char* const> encoders = kH264Encoders);

  /// A picture of the format's size, CV_8UC3, blue first. Throws Error(kIo).
  void add(const cv::Mat& bgr);
  /// Throws Error(kIo).
  void finish();

  std::int64_t num_frames() const { return num_frames_; }

 private:
  struct Deleter {
    void operator()(AVCodecContext* context) const;
    void operator()(AVFrame* frame) const;
    void operator()(AVPacket* packet) const;
    void operator()(SwsContext* context) const;
  };

  void open_codec(const AVCodec& encoder, const Format& format);
  /// nullptr: no more frames will come.
  void encode(const AVFrame* frame);

  std::string name_;
  OutputFile file_;
  std::unique_ptr<AVCodecContext, Deleter> codec_;
  std::unique_ptr<SwsContext, Deleter> converter_;
  std::unique_ptr<AVFrame, Deleter> frame_;
  std::unique_ptr<AVPacket, Deleter> packet_;
  cv::Mat padded_;              ///< The converter reads whole vectors, beyond the end of a row.
  AVStream* stream_ = nullptr;  ///< Owned by file_.
  std::int64_t num_frames_ = 0;
};

}  // namespace apriltrack
