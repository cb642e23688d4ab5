#pragma once

#include <vector>

#include "apriltrack/base/parallel.h"
#include "model/adjusted_part.h"
#include "model/outcome.h"
#include "model/solve_context.h"

namespace apriltrack {

/// What of the part has a pose to start from: a lens may not reach some views. Empty where the tag that is
/// held has none.
Part with_poses(const PartTask& task, const Part& part, int held_tag);

/// Start, robust adjustment, mirrored tags turned, outliers removed, clean adjustment; mirrored tags are
/// looked for once more when the noise of what fits is known, which tells poses apart that outliers hid. Of
/// what has poses to start from. No map where it does not converge, or nothing fits.
Outcome<AdjustedPart> adjust_part(const PartTask& task, const Part& part, int held_tag,
                                  const ParallelFor& parallel);

/// Cauchy's scale, on a view's whitened norm (a good one's is sqrt(8)).
inline constexpr double kRobustLoss = 6.0;

/// Takes `state` to the nearest minimum of the robust cost of all views, by one noise for all of them. Why
/// there is none, if so.
std::optional<NoMap> settle_robustly(const PartTask& task, const Part& part, int held_tag, MapState& state);

/// Least squares over the inliers, which are chosen anew until they stay the same; these are returned. No map
/// where nothing fits, or it does not converge: `state` is then of no use.
Outcome<Part> adjust_cleanly(const PartTask& task, const Part& part, int held_tag, MapState& state);

/// Those that agree with the map, by the noise that it has.
std::vector<std::size_t> inliers(const Observations& observations, const std::vector<std::size_t>& views,
                                 const MapState& state);

/// Of a map of the part: what it contradicts.
Contradictions contradictions_of(const PartTask& task, const Part& part, const MapState& state);

}  // namespace apriltrack
