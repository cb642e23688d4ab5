#include <fmt/format.h>

#include <algorithm>
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
    if (has_times_ && rate_hz_) refuse_another_rate();
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
      warn_if_cut();
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
  /// As of images whose names are times.
  void refuse_another_rate() const {
    constexpr double kMaxRatio = 3.0;
    const double stored_hz = decoder_.rate_hz();
    if (stored_hz == 0.0 || (*rate_hz_ <= kMaxRatio * stored_hz && stored_hz <= kMaxRatio * *rate_hz_))
      return;
    throw invalid_input(name_,
                        fmt::format("its frames carry times, {:.4g} a second, but --rate says {:g}: leave it "
                                    "out. A slow-motion film is given the times of its camera by `ffmpeg "
                                    "-itsscale {:.4g} -i FILM -c copy OUT`",
                                    stored_hz, *rate_hz_, stored_hz / *rate_hz_));
  }
  void warn_if_cut() {
    if (has_reported_) return;
    const std::string missing = decoder_.num_promised() ? missing_frames() : missing_time();
    if (missing.empty()) return;
    has_reported_ = true;
    log_(LogLevel::kWarning, fmt::format("{}: the file is cut off or damaged: {}", name_, missing));
  }
  std::string missing_frames() const {
    if (decoder_.num_whole() >= *decoder_.num_promised()) return "";
    return fmt::format("{} of the {} frames that its header promises are there", decoder_.num_whole(),
                       *decoder_.num_promised());
  }
  /// Where the header counts no frames. The last one is shown for a while that nobody tells.
  std::string missing_time() const {
    constexpr double kLeast_s = 0.2, kFewFrames = 3.0;
    const double shown_s = decoder_.shown_s();
    const double interval_s = shown_s / static_cast<double>(std::max<std::size_t>(1, decoder_.num_whole()));
    if (!decoder_.promised_s() ||
        *decoder_.promised_s() - shown_s <= std::max(kLeast_s, kFewFrames * interval_s))
      return "";
    return fmt::format("its {} frames end after {:.1f} of the {:.1f} s that its header promises",
                       decoder_.num_whole(), shown_s, *decoder_.promised_s());
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
  bool has_reported_ = false;
};

}  // namespace

std::unique_ptr<SkippableSource> open_video(const std::filesystem::path& path, std::optional<double> rate_hz,
                                            const LogSink& log) {
  return std::make_unique<VideoFile>(path.string(), rate_hz, log);
}

}  // namespace apriltrack
