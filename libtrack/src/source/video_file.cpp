#include <fmt/format.h>

#include <utility>

#include "apriltrack/base/error.h"
#include "forward_clock.h"
#include "video_decoder.h"
#include "video_source.h"

namespace apriltrack {
namespace {

class VideoFile : public SkippableSource {
 public:
  VideoFile(std::string name, std::optional<double> rate_hz, LogSink log)
      : name_(std::move(name)), rate_hz_(rate_hz), log_(std::move(log)), decoder_(name_) {
    pending_ = decoder_.advance();
    if (!pending_) throw io_error(name_, "opens as a video, but not one frame of it can be read");
    has_times_ = decoder_.has_times() && (pending_->timestamp || !pending_->error.empty());
    if (!has_times_ && !rate_hz_)
      throw invalid_input(name_, "its frames carry no times: give the frame rate with --rate HZ");
  }

  std::optional<SourceFrame> next() override {
    if (!pass_over()) return std::nullopt;
    SourceFrame frame;
    frame.name = fmt::format("{} frame {}", name_, num_passed_ - 1);
    frame.timestamp = clock_.time();
    frame.error = error_;
    if (frame.error.empty()) {
      frame.pixels = decoder_.picture();
      if (frame.pixels.is_empty()) frame.error = "its pixels cannot be converted to grey";
    }
    return frame;
  }

  bool pass_over() override {
    const auto decoded = pending_ ? std::exchange(pending_, std::nullopt) : decoder_.advance();
    if (!decoded) {
      tell_if_cut();
      return false;
    }
    const auto told =
        has_times_ ? decoded->timestamp : advance({}, static_cast<double>(num_passed_) / *rate_hz_);
    const std::string time_error = clock_.take(told);
    error_ = decoded->error.empty() ? time_error : decoded->error;
    ++num_passed_;
    return true;
  }

  std::optional<std::size_t> num_frames() const override { return decoder_.num_frames(); }
  std::string name() const override { return name_; }

 private:
  void tell_if_cut() {
    const auto promised = decoder_.num_promised();
    if (has_told_ || !promised || decoder_.num_whole() >= *promised) return;
    has_told_ = true;
    log_(LogLevel::kWarning,
         fmt::format(
             "{}: the file is cut off or damaged: {} of the {} frames that its header promises are there",
             name_, decoder_.num_whole(), *promised));
  }

  std::string name_;
  std::optional<double> rate_hz_;
  LogSink log_;
  VideoDecoder decoder_;
  std::optional<VideoDecoder::Decoded> pending_;
  bool has_times_ = true;
  std::size_t num_passed_ = 0;
  ForwardClock clock_;
  std::string error_;
  bool has_told_ = false;
};

}  // namespace

std::unique_ptr<SkippableSource> open_video(const std::filesystem::path& path, std::optional<double> rate_hz,
                                            const LogSink& log) {
  return std::make_unique<VideoFile>(path.string(), rate_hz, log);
}

}  // namespace apriltrack
