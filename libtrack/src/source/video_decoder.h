#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "apriltrack/base/timestamp.h"
#include "apriltrack/image/image.h"
#include "gray_converter.h"
#include "video_bytes.h"

struct AVCodecContext;
struct AVFormatContext;
struct AVFrame;
struct AVIOContext;
struct AVPacket;
struct AVStream;

namespace apriltrack {

/// Decodes the video stream of a file, frame by frame in the order of showing.
///
/// FFmpeg itself and not cv::VideoCapture, whose times (OpenCV 4.6) are those of decoding: wrong where frames
/// are stored in another order than shown and the rate varies, and zero for the last frames of such a file.
class VideoDecoder {
 public:
  /// Throws Error(kIo) when the file cannot be opened or has no video that can be decoded.
  explicit VideoDecoder(const std::string& path);

  /// A frame as it left the decoder; its picture is made only if asked for.
  struct Decoded {
    std::optional<Timestamp> timestamp;  ///< Since the stream's start; none where the file gives no time.
    std::string error;                   ///< Why there is no picture; empty for a good frame.
  };
  /// nullopt at the end. A packet that cannot be decoded is a frame with an error; a decoder that fails on
  /// and on without being fed is at its end.
  std::optional<Decoded> advance();
  /// The picture of the frame last advanced to, turned upright as the file says; empty when it cannot be
  /// converted.
  GrayImage picture();

  /// As the file's header states it, or as estimated from duration and rate.
  std::optional<std::size_t> num_frames() const;
  /// How many frames a whole file has, as its header counts them; none where that counts none (Matroska, raw
  /// streams).
  std::optional<std::size_t> num_promised() const { return num_promised_; }
  /// Of the frames whose data were there so far, and not cut off.
  std::size_t num_whole() const { return num_whole_; }
  /// How long a whole file's pictures go on, as its header says; none where that tells no duration of its own
  /// for them.
  std::optional<double> promised_s() const { return promised_s_; }
  /// Until when the last of the whole frames so far is shown, by the same clock; as far as the file tells.
  double shown_s() const { return shown_s_; }
  /// Of its frames' times, as the header states or FFmpeg estimates it; 0 where nothing tells it.
  double rate_hz() const;
  /// False for raw streams, whose times the demuxer makes up.
  bool has_times() const;

 private:
  struct Deleter {
    void operator()(AVFormatContext* context) const;
    void operator()(AVIOContext* context) const;
    void operator()(AVCodecContext* context) const;
    void operator()(AVFrame* frame) const;
    void operator()(AVPacket* packet) const;
  };

  void open_file();
  void open_stream();
  /// Feeds the decoder one packet; the word of what is wrong with it, if anything is.
  std::optional<Decoded> feed();
  std::optional<Timestamp> time_of(std::int64_t stream_time);

  VideoBytes bytes_;
  std::unique_ptr<AVIOContext, Deleter> reader_;  ///< Of bytes_.
  std::unique_ptr<AVFormatContext, Deleter> file_;
  std::unique_ptr<AVCodecContext, Deleter> codec_;
  std::unique_ptr<AVFrame, Deleter> frame_;
  std::unique_ptr<AVPacket, Deleter> packet_;
  GrayConverter converter_;
  AVStream* stream_ = nullptr;         ///< Owned by file_.
  int turns_ = 0;                      ///< Quarter turns anticlockwise that stand the picture upright.
  std::optional<std::int64_t> start_;  ///< In the stream's units; the first frame's time where none is told.
  bool is_draining_ = false;
  std::optional<std::size_t> num_promised_;
  std::size_t num_whole_ = 0;
  std::optional<double> promised_s_;
  double shown_s_ = 0.0;
  int num_idle_errors_ = 0;  ///< Since the decoder was last fed.
};

}  // namespace apriltrack
