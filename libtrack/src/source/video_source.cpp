#include "video_source.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <opencv2/videoio.hpp>
#include <utility>

#include "apriltrack/base/error.h"
#include "gray_pixels.h"

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
    if (frame.pixels.is_empty()) frame.error = frame.name + ": cannot be decoded";
  } catch (const cv::Exception& error) {
    frame.error = fmt::format("{}: cannot be decoded: {}", frame.name, error.err);
  }
  return frame;
}

class VideoFile : public SkippableSource {
 public:
  VideoFile(std::string name, std::optional<double> rate_hz) : name_(std::move(name)) {
    // FFmpeg by name: other backends take a lone image for the first of a numbered series, or invent times.
    if (!capture_.open(name_, cv::CAP_FFMPEG))
      throw io_error(name_, "is neither an image nor a video that can be read");
    period_s_ = 1.0 / rate_hz.value_or(capture_.get(cv::CAP_PROP_FPS));
    if (!advance_to_frame()) throw io_error(name_, "opens as a video, but not one frame of it can be read");
    is_first_waiting_ = true;
  }

  std::optional<SourceFrame> next() override {
    if (!pass_over()) return std::nullopt;
    SourceFrame frame = retrieve_frame(capture_, fmt::format("{} frame {}", name_, num_grabbed_ - 1));
    frame.timestamp = time_;
    if (frame.is_readable() && !time_error_.empty()) {
      frame.error = fmt::format("{}: {}", frame.name, time_error_);
      frame.pixels = {};
    }
    return frame;
  }

  bool pass_over() override {
    if (std::exchange(is_first_waiting_, false)) return true;
    return advance_to_frame();
  }

  std::optional<std::size_t> num_frames() const override {
    const double count = capture_.get(cv::CAP_PROP_FRAME_COUNT);
    if (!(count >= 1.0 && count < 1e9)) return std::nullopt;
    return static_cast<std::size_t>(count);
  }

  std::string name() const override { return name_; }

 private:
  bool advance_to_frame() {
    if (!capture_.grab()) return false;
    const Timestamp told = grabbed_time(capture_);
    // Raw streams carry no times: every frame is then "at" the same one, which the second frame shows.
    if (num_grabbed_ == 1) has_times_ = told > time_;
    time_error_.clear();
    if (num_grabbed_ == 0) {
      time_ = told;
    } else if (!has_times_) {
      count_time();
    } else if (told > time_) {
      time_ = told;
    } else {
      time_error_ = fmt::format("its time, {} s, is not later than the frame's before", format_seconds(told));
      time_ = {time_.ns + 1};
    }
    ++num_grabbed_;
    return true;
  }

  void count_time() {
    if (!std::isfinite(period_s_) || period_s_ <= 0.0)
      throw invalid_input(name_, "its frames carry no times: give the frame rate with --rate HZ");
    if (num_grabbed_ == 1) start_ = time_;
    time_ = advance(start_, static_cast<double>(num_grabbed_) * period_s_);
  }

  std::string name_;
  cv::VideoCapture capture_;
  double period_s_ = 0.0;
  std::size_t num_grabbed_ = 0;
  bool is_first_waiting_ = false;
  bool has_times_ = true;
  Timestamp start_;
  Timestamp time_;
  std::string time_error_;
};

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
    frame.timestamp = time_;
    return frame;
  }

  bool pass_over() override {
    if (!capture_.grab()) return false;
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    const Timestamp arrival{std::chrono::duration_cast<std::chrono::nanoseconds>(now).count()};
    const Timestamp told = grabbed_time(capture_);
    if (num_grabbed_ == 0) driver_tells_time_ = told.ns > 0;
    time_ = driver_tells_time_ ? told : arrival;
    ++num_grabbed_;
    return true;
  }

  std::optional<std::size_t> num_frames() const override { return std::nullopt; }
  std::string name() const override { return name_; }

 private:
  std::string name_;
  cv::VideoCapture capture_;
  std::size_t num_grabbed_ = 0;
  bool driver_tells_time_ = false;
  Timestamp time_;
};

}  // namespace

std::unique_ptr<SkippableSource> open_video(const std::filesystem::path& path,
                                            std::optional<double> rate_hz) {
  return std::make_unique<VideoFile>(path.string(), rate_hz);
}

std::unique_ptr<SkippableSource> open_live_camera(int number, const std::string& where) {
  return std::make_unique<LiveCamera>(number, where);
}

}  // namespace apriltrack
