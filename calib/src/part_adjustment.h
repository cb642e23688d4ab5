#pragma once

#include <string_view>
#include <vector>

#include "apriltrack/base/parallel.h"
#include "apriltrack/calib/calibrate_map.h"
#include "contradictions.h"
#include "corner_noise.h"
#include "map_state.h"
#include "tag_finding.h"

namespace apriltrack {

inline constexpr std::string_view kWhatToCheck =
    "check the tag family (--family) and the tag sizes, the camera file, that all pictures have its size, "
    "and that no tag was moved while filming";

/// Everything that the solving of a part needs besides the part.
struct PartTask {
  const Observations& observations;
  const std::vector<ViewCandidates>& candidates;
  const CalibrationOptions& options;
};

/// For what is one of several bodies that run side by side; asks whether to stop.
ParallelFor on_one_thread(const PartTask& task);

/// An adjusted part, and how it agrees with its frames.
struct AdjustedPart {
  int held_tag = 0;
  Part part;  ///< What was kept: outliers, and tags that hung on them alone, are gone.
  MapState state;
  Contradictions contradictions;
  std::vector<int> culprits = {};   ///< Left out, for the frames contradict each other with them.
  std::vector<int> undecided = {};  ///< Left out, for the views leave them two poses.
  /// Of culprits: one of these is so, and the views do not tell which.
  std::vector<TagFinding> rivals = {};
};

/// What of the part has a pose to start from: a lens may not reach some views. Empty where the tag that is
/// held has none.
Part with_poses(const PartTask& task, const Part& part, int held_tag);

/// How often mirrored tags are looked for: before outliers are removed, and again when the noise of what fits
/// is known, which tells poses apart that outliers hid. Once does where maps are only compared.
enum class MirrorTests { kBeforeAndAfter, kBefore };

/// Start, robust adjustment, mirrored tags turned, outliers removed, clean adjustment; of what has poses to
/// start from. Throws Error(kNoResult) when it does not converge, or when nothing fits.
AdjustedPart adjust_part(const PartTask& task, const Part& part, int held_tag, const ParallelFor& parallel,
                         MirrorTests tests = MirrorTests::kBeforeAndAfter);

/// Least squares over the inliers, which are chosen anew until they stay the same; these are returned.
Part adjust_cleanly(const PartTask& task, const Part& part, int held_tag, MapState& state);

/// All but the one that is held.
std::vector<int> free_tags(const Part& part, int held_tag);

/// Those that agree with the map, by the noise that it has.
std::vector<std::size_t> inliers(const Observations& observations, const std::vector<std::size_t>& views,
                                 const MapState& state);

/// Of a map of the part: what it contradicts.
Contradictions contradictions_of(const PartTask& task, const Part& part, const MapState& state);

/// What of `part` the views still tie to the held tag; an empty part when it stands alone.
Part connected_to(const Observations& observations, const std::vector<std::size_t>& views, int held_tag,
                  int min_views);

/// residual_px: if given, the same before it is whitened.
Vector8d whitened_residual(const Observations& observations, const TagView& view, const MapState& state,
                           bool& is_valid, Vector8d* residual_px = nullptr);

}  // namespace apriltrack
