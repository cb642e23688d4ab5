#include "hypotheses/agreeing_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "apriltrack/base/error.h"
#include "apriltrack/base/parallel.h"
#include "apriltrack/calib/calibration_options.h"
#include "faults/part_without.h"
#include "faults/tag_fault.h"
#include "faults/tag_probe.h"
#include "hypotheses/culprit_search.h"
#include "hypotheses/part_failure.h"
#include "hypotheses/rivals.h"
#include "solve/camera_parameters.h"

namespace apriltrack {
namespace {

constexpr double kOtherFocalLengths[] = {-0.07, -0.035, 0.035, 0.07};  // shares
constexpr double kMostOfViews = 0.9;                                   // of the views
constexpr double kClearlyMore = 0.03;                                  // of them

/// Of the views, but for those of culprits.
double kept_share(const Observations& observations, const Part& part,
                  const std::optional<AdjustedPart>& solved) {
  if (!solved || solved->contradictions.are_there()) return 0.0;
  const auto offered = std::ranges::count_if(part.views, [&](std::size_t v) {
    return std::ranges::find(solved->culprits, observations.views[v].tag) == solved->culprits.end();
  });
  return static_cast<double>(solved->part.views.size()) / static_cast<double>(offered);
}

/// Of views that count: what hides under more noise is not explained by it.
double noise_of(const std::optional<AdjustedPart>& solved) {
  return solved ? std::hypot(solved->state.noise.sum, solved->state.noise.difference)
                : std::numeric_limits<double>::infinity();
}

/// Where the views contradict each other, or many were rejected, the focal length may be why: one that most
/// of them agree with, with no more than `noise`, if there is one.
std::optional<AdjustedPart> adjust_with_other_focal_length(const PartTask& task, const Part& part,
                                                           int held_tag, double share, double noise,
                                                           const ParallelFor& parallel) {
  std::optional<AdjustedPart> best;
  for (const double change : kOtherFocalLengths) {
    Observations other = task.observations;
    for (RigCamera& camera : other.cameras)
      camera = moved(camera, {.kind = CameraParameter::Kind::kFocalLength}, change).value();
    const std::vector<ViewCandidates> candidates = solve_views(other, part.views, parallel);
    Outcome<AdjustedPart> solved = adjust_part({other, candidates, task.options}, part, held_tag, parallel);
    if (!solved) continue;
    const double of_this = kept_share(task.observations, part, *solved);
    if (of_this < share + kClearlyMore || of_this < kMostOfViews || noise_of(*solved) > noise) continue;
    share = of_this;
    best = std::move(*solved);
  }
  return best;
}

/// No map can be held by a tag that all others contradict: throws Error(kNoResult) where the one that the
/// user holds is that.
void require_held_tag_that_fits(const PartTask& task, const Part& part, const Contradictions& contradictions,
                                int held_tag, const ParallelFor& parallel, const LogSink& log) {
  if (!is_held_by_wish(task, held_tag)) return;
  CalibrationOptions options = task.options;
  options.held_tag.reset();
  const PartTask any{task.observations, task.candidates, options};
  const auto rest = adjust_without_culprit(any, part, contradictions, held_tag, parallel, log);
  if (!rest || rest->culprits != std::vector{held_tag}) return;
  const auto finding = look_at(any, *rest, probe_views(any, part, *rest, held_tag), held_tag).finding;
  if (finding) throw HeldTagAtFault(with_rivals(any, part, *rest, {}, *finding));
  throw HeldTagAtFault(held_tag);
}

}  // namespace

AdjustedPart adjust_without_contradictions(const PartTask& task, const Part& part, int held_tag,
                                           const ParallelFor& parallel, const LogSink& log) {
  Outcome<AdjustedPart> first = adjust_part(task, part, held_tag, parallel);
  std::optional<NoMap> failure;  // one tag may be the cause, or the camera file
  std::optional<AdjustedPart> solved;
  if (first)
    solved = std::move(*first);
  else
    failure = first.why();
  if (solved && !solved->contradictions.are_there() &&
      kept_share(task.observations, part, solved) > kMostOfViews)
    return std::move(*solved);
  const Contradictions contradictions = solved ? solved->contradictions : Contradictions{};
  std::optional<AdjustedPart> without;
  if (failure || contradictions.are_there())
    without = adjust_without_culprit(task, part, contradictions, held_tag, parallel, log);
  if (!without && (failure || contradictions.are_there()))
    require_held_tag_that_fits(task, part, contradictions, held_tag, parallel, log);
  const double share =
      std::max(kept_share(task.observations, part, solved), kept_share(task.observations, part, without));
  if (task.options.intrinsics != Intrinsics::kKeep && share < kMostOfViews) {
    if (auto other = adjust_with_other_focal_length(task, part, held_tag, share, noise_of(solved), parallel))
      return std::move(*other);
  }
  if (without) return std::move(*without);
  if (failure) throw failure->to_error();
  if (contradictions.are_there()) throw contradictory(task.observations, contradictions).to_error();
  return std::move(*solved);
}

}  // namespace apriltrack
