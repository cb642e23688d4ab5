#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <opencv2/videoio.hpp>
#include <utility>

#include "apriltrack/base/error.h"
#include "forward_clock.h"
#include "gray_pixels.h"
#include "video_source.h"

namespace apriltrack {
namespace {

/// True only after a frame was grabbed: before, OpenCV tells where it will look, not what it found.
Timestamp grabbed_time(const cv::VideoCapture& capture) {
  return {std::llround(capture.get(cv::CAP_PROP_POS_MSEC) * 1e6)};
}

SourceFrame retrieve_frame(cv::VideoCapture& capture, std::string name) {
  SourceFrame frame;
  frame.name = std::move(name);
  cv::Mat picture;
  try {
    if (capture.retrieve(picture)) frame.pixels = gray_of(picture);
    if (frame.pixels.is_empty()) frame.error = "cannot be decoded";
  } catch (const cv::Exception& error) {
    frame.error = fmt::format("cannot be decoded: {}", error.err);
  }
  return frame;
}

class LiveCamera : public SkippableSource {
 public:
  LiveCamera(int number, std::string name) : name_(std::move(name)) {
    if (!capture_.open(number, cv::CAP_V4L2)) {
      throw io_error(
          name_, "no camera there that can be opened: is it plugged in, free, and may this user read it?");
    }
  }

  std::optional<SourceFrame> next() override {
    if (!pass_over()) return std::nullopt;
    SourceFrame frame = retrieve_frame(capture_, fmt::format("{} frame {}", name_, num_grabbed_ - 1));
    frame.timestamp = clock_.time();
    if (frame.error.empty()) frame.error = time_error_;
    return frame;
  }

  bool pass_over() override {
    if (!capture_.grab()) return false;
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    const Timestamp arrival{std::chrono::duration_cast<std::chrono::nanoseconds>(now).count()};
    const Timestamp told = grabbed_time(capture_);
    if (num_grabbed_ == 0) has_driver_time_ = told.ns > 0;
    const auto believed = told.ns > 0 ? std::optional(told) : std::nullopt;  // 0: the driver did not say
    time_error_ = clock_.take(has_driver_time_ ? believed : arrival);
    ++num_grabbed_;
    return true;
  }

  std::optional<std::size_t> num_frames() const override { return std::nullopt; }
  std::string name() const override { return name_; }

 private:
  std::string name_;
  cv::VideoCapture capture_;
  std::size_t num_grabbed_ = 0;
  bool has_driver_time_ = false;
  ForwardClock clock_;
  std::string time_error_;
};

}  // namespace

std::unique_ptr<SkippableSource> open_live_camera(int number, const std::string& where) {
  return std::make_unique<LiveCamera>(number, where);
}

}  // namespace apriltrack
