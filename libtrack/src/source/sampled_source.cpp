#include "sampled_source.h"

#include <fmt/format.h>

#include <algorithm>

#include "apriltrack/base/error.h"

namespace apriltrack {
namespace {

/// From a frame's stamp to the middle of the exposure of its middle row; capture_s: from the start of the
/// first row's to the end of the last row's.
double seconds_to_middle(StampIs stamp_is, double capture_s) {
  switch (stamp_is) {
    case StampIs::kStart:
      return 0.5 * capture_s;
    case StampIs::kEnd:
      return -0.5 * capture_s;
    case StampIs::kMiddle:
      break;
  }
  return 0.0;
}

}  // namespace

SampledSource::SampledSource(std::unique_ptr<SkippableSource> source, const SourceOptions& options)
    : source_(std::move(source)), options_(options) {
  if (options.stamp_is == StampIs::kMiddle || options.exposure_s || source_->tells_all_exposures()) return;
  throw invalid_input(
      "--stamp-is",
      fmt::format("'{}' moves times by half the exposure, which nothing tells: give exposure_time "
                  "(seconds) in the camera file, --camera",
                  options.stamp_is == StampIs::kStart ? "start" : "end"));
}

std::optional<SourceFrame> SampledSource::next() {
  if (options_.max_frames && num_taken_ >= *options_.max_frames) return std::nullopt;
  const std::size_t left_out = num_taken_ == 0 ? options_.skip : options_.step - 1;
  for (std::size_t i = 0; i < left_out; ++i) {
    if (!source_->pass_over()) return std::nullopt;
  }
  ++num_taken_;
  std::optional<SourceFrame> frame = source_->next();
  if (!frame || options_.stamp_is == StampIs::kMiddle) return frame;
  const double exposure_s = frame->exposure_s ? *frame->exposure_s : options_.exposure_s.value_or(0.0);
  frame->timestamp =
      advance(frame->timestamp, seconds_to_middle(options_.stamp_is, exposure_s + options_.readout_s));
  return frame;
}

std::optional<std::size_t> SampledSource::num_frames() const {
  const auto all = source_->num_frames();
  if (!all) return std::nullopt;
  const std::size_t rest = *all - std::min(*all, options_.skip);
  const std::size_t sampled = (rest + options_.step - 1) / options_.step;
  return std::min(sampled, options_.max_frames.value_or(sampled));
}

}  // namespace apriltrack
