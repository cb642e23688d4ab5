#include "initialise/part_adjustment.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "apriltrack/calib/calibration_options.h"
#include "initialise/mirror_test.h"
#include "initialise/mirrored_frames.h"
#include "solve/bundle_adjustment.h"
#include "uncertainty/noise_scale.h"

namespace apriltrack {
namespace {

constexpr double kCoarseLoss = 30.0;   // views are some ten pixels off at the start
constexpr double kMaxViewRms = 4.0;    // sigmas; one in 1e18 good views
constexpr double kMaxComponent = 6.0;  // sigmas; one corner off, the rest of the tag in place
// The same by the tails of what detectors claim: one in 10,000 views, and one number of them.
constexpr double kMaxViewRmsOfClaimed = 12.0, kMaxComponentOfClaimed = 22.0;
constexpr int kMaxRounds = 4;
constexpr double kGross_px = 1.0;
constexpr double kGrossPerEdge = 0.1;

/// Views so far off that no noise, lens or print explains it, against the size that the tag has in the image.
std::vector<std::size_t> gross_outliers(const Observations& observations,
                                        const std::vector<std::size_t>& views, const MapState& state) {
  std::vector<std::size_t> gross;
  for (const std::size_t v : views) {
    bool is_valid = false;
    Vector8d residual_px;
    const TagView& view = observations.views[v];
    whitened_residual(observations, view, state, is_valid, &residual_px);
    std::array<double, kNumCorners> distances_px;
    for (int corner = 0; corner < kNumCorners; ++corner)
      distances_px[static_cast<std::size_t>(corner)] = residual_px.segment<2>(2 * corner).norm();
    std::ranges::sort(distances_px);
    const double distance_px = distances_px[1];  // one corner or two drawn off speak of no other place
    if (!is_valid || distance_px > kGross_px + kGrossPerEdge * mean_edge_px(view.corners_px))
      gross.push_back(v);
  }
  return gross;
}

NoMap contradictory_around(const Observations& observations, int held_tag) {
  return {fmt::format("the observations around {} contradict each other: {}",
                      to_string(observations.tags[static_cast<std::size_t>(held_tag)]), kWhatToCheck)};
}

/// What keeps it from being usable, if anything does. Steps that run out are no failure yet: the clean
/// adjustment must converge.
std::optional<NoMap> adjust_with_loss(const PartTask& task, const Part& part, int held_tag, double loss_scale,
                                      MapState& state) {
  const AdjustmentSummary summary = adjust(task.observations, part.views, free_tags(part, held_tag),
                                           adjustment_options(task.options, loss_scale), state);
  if (summary.is_usable) return std::nullopt;
  return NoMap{fmt::format("the robust adjustment of {} tags failed ({}); {}", part.tags.size(),
                           summary.message, kWhatToCheck)};
}

/// From the start.
std::optional<NoMap> adjust_robustly(const PartTask& task, const Part& part, int held_tag, MapState& state) {
  state.noise = {};
  if (auto failure = adjust_with_loss(task, part, held_tag, kCoarseLoss, state)) return failure;
  return settle_robustly(task, part, held_tag, state);
}

}  // namespace

std::optional<NoMap> settle_robustly(const PartTask& task, const Part& part, int held_tag, MapState& state) {
  state.noise = measure_noise(task.observations, part.views, state);
  return adjust_with_loss(task, part, held_tag, kRobustLoss, state);
}

std::vector<std::size_t> inliers(const Observations& observations, const std::vector<std::size_t>& views,
                                 const MapState& state) {
  std::vector<std::size_t> kept;
  for (const std::size_t v : views) {
    bool is_valid = false;
    const TagView& view = observations.views[v];
    const bool is_claimed = view.claimed_px2 > 0.0;
    const Vector8d whitened = whitened_residual(observations, view, state, is_valid);
    const double rms = std::sqrt(whitened.squaredNorm() / 8.0);
    if (is_valid && rms <= (is_claimed ? kMaxViewRmsOfClaimed : kMaxViewRms) &&
        whitened.cwiseAbs().maxCoeff() <= (is_claimed ? kMaxComponentOfClaimed : kMaxComponent))
      kept.push_back(v);
  }
  return kept;
}

Outcome<Part> adjust_cleanly(const PartTask& task, const Part& part, int held_tag, MapState& state) {
  const auto& [observations, candidates, options] = task;
  Part kept;
  for (int round = 0; round < kMaxRounds; ++round) {
    state.noise = measure_noise(observations, part.views, state);
    Part next =
        connected_to(observations, inliers(observations, part.views, state), held_tag, options.min_views);
    if (next.tags.size() < 2) return contradictory_around(observations, held_tag);
    state.noise.of_view = measure_view_noise(observations, next.views, state);
    state.noise.of_frame = measure_frame_noise(observations, next.views, state);
    if (next.views == kept.views) return kept;
    kept = std::move(next);
    const AdjustmentSummary summary =
        adjust(observations, kept.views, free_tags(kept, held_tag), adjustment_options(options), state);
    if (!summary.is_usable || !summary.has_converged)
      return NoMap{
          fmt::format("the adjustment of {} tags did not converge ({}); more views of each tag, "
                      "from more sides, usually help; else {}",
                      kept.tags.size(), summary.message, kWhatToCheck)};
  }
  return kept;
}

Part with_poses(const PartTask& task, const Part& part, int held_tag) {
  std::vector<std::size_t> views;
  std::ranges::copy_if(part.views, std::back_inserter(views),
                       [&](std::size_t v) { return !task.candidates[v].candidates.empty(); });
  return views.size() == part.views.size()
             ? part
             : connected_to(task.observations, views, held_tag, task.options.min_views);
}

Contradictions contradictions_of(const PartTask& task, const Part& part, const MapState& state) {
  return find_contradictions(task.observations, part, gross_outliers(task.observations, part.views, state));
}

Outcome<AdjustedPart> adjust_part(const PartTask& task, const Part& offered, int held_tag,
                                  const ParallelFor& parallel) {
  const auto& [observations, candidates, options] = task;
  const Part part = with_poses(task, offered, held_tag);
  if (part.tags.size() < 2) return contradictory_around(observations, held_tag);
  AdjustedPart result{.held_tag = held_tag,
                      .part = {},
                      .state = start_state(observations, part, held_tag, candidates, parallel),
                      .contradictions = {}};
  const auto adjust_again = [&]() -> std::optional<NoMap> {  // result.part: the views that fit
    Outcome<Part> kept = adjust_cleanly(task, part, held_tag, result.state);
    if (!kept) return kept.why();
    result.part = std::move(*kept);
    return std::nullopt;
  };
  if (auto failure = adjust_robustly(task, part, held_tag, result.state)) return *failure;
  for (int round = 0; round < kMaxRounds; ++round) {
    if (!turn_mirrored_groups(task, part, held_tag, result.state, parallel)) {
      if (auto failure = adjust_again()) return *failure;
      if (!turn_mirrored_groups(task, part, held_tag, result.state, parallel)) break;
    }
    if (auto failure = adjust_robustly(task, part, held_tag, result.state)) return *failure;
    result.part = {};
  }
  if (result.part.tags.empty()) {
    if (auto failure = adjust_again()) return *failure;
  }
  for (int round = 0; round < kMaxRounds; ++round) {
    const Part kept_tags = narrowed_to(observations, part, result.part.tags);
    if (!turn_mirrored_frames(task, kept_tags, result.state, parallel)) break;
    if (auto failure = adjust_again()) return *failure;
  }
  result.contradictions = contradictions_of(task, part, result.state);
  return result;
}

}  // namespace apriltrack
