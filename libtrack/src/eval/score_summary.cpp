#include "score_summary.h"

#include <algorithm>
#include <array>
#include <iterator>

#include "apriltrack/eval/statistics.h"

namespace apriltrack {
namespace {

constexpr double kSuccess_px = 5.0;
constexpr std::array<double, 6> kBlurBinStarts_px = {0.0, 2.0, 5.0, 10.0, 20.0, 40.0};

}  // namespace

ErrorSummary summarise(const std::vector<FrameScore>& frames, bool has_scene) {
  std::vector<double> corners_px;
  std::vector<double> positions_m;
  std::vector<double> rotations_rad;
  for (const FrameScore& frame : frames) {
    if (frame.corner_error_px) corners_px.push_back(*frame.corner_error_px);
    if (!frame.error) continue;
    positions_m.push_back(frame.error->position_m);
    rotations_rad.push_back(frame.error->rotation_rad);
  }
  ErrorSummary summary;
  summary.frames = static_cast<int>(frames.size());
  const auto num_good =
      std::ranges::count_if(corners_px, [](double error_px) { return error_px < kSuccess_px; });
  if (has_scene && !frames.empty()) summary.success_5px = static_cast<double>(num_good) / summary.frames;
  if (positions_m.empty()) return summary;
  summary.coverage = static_cast<double>(positions_m.size()) / summary.frames;
  summary.position_rmse_m = root_mean_square(positions_m);
  summary.rotation_rmse_rad = root_mean_square(rotations_rad);
  summary.position_median_m = median(positions_m);
  summary.rotation_median_rad = median(rotations_rad);
  if (corners_px.empty()) return summary;
  summary.median_px = median(corners_px);
  summary.p95_px = percentile(corners_px, 0.95);
  return summary;
}

std::vector<BlurBin> bin_by_blur(const std::vector<FrameScore>& frames) {
  std::vector<BlurBin> bins;
  for (std::size_t b = 0; b < kBlurBinStarts_px.size(); ++b) {
    BlurBin bin;
    bin.from_px = kBlurBinStarts_px[b];
    if (b + 1 < kBlurBinStarts_px.size()) bin.to_px = kBlurBinStarts_px[b + 1];
    std::vector<FrameScore> inside;
    std::ranges::copy_if(frames, std::back_inserter(inside), [&](const FrameScore& frame) {
      return frame.blur_px >= bin.from_px && frame.blur_px < bin.to_px;
    });
    if (inside.empty()) continue;
    bin.summary = summarise(inside, true);
    bins.push_back(bin);
  }
  return bins;
}

}  // namespace apriltrack
