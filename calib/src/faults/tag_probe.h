#pragma once

#include <vector>

#include "initialise/part_adjustment.h"

namespace apriltrack {

/// Views of a tag that are looked at.
inline constexpr std::size_t kMostProbes = 160;

/// One view of a tag, as the other tags of its frame foretell it: the frame's pose rests on them alone.
struct ProbeView {
  const TagView* view = nullptr;
  const RigCamera* camera = nullptr;
  bool is_frame_sure = false;  ///< Two other tags or more agree on where it is.
  Pose T_map_rig;
  Timestamp timestamp;
  /// Turns reprojection errors (px) into independent numbers of unit variance, the frame's own error
  /// included.
  Matrix8d whitening = Matrix8d::Identity();
  /// What it counts, of one view (viewpoint_shares.h); 1 where the detector claims nothing.
  double share = 1.0;
  std::vector<std::size_t> others = {};       ///< Views of its frame, on which the pose rests.
  std::vector<Pose> T_map_tag_proposed = {};  ///< Where the tag may be by this view, at its stated size.
};

/// Of the views of `tag` (outliers, too) in frames that show another tag of the solved part, up to
/// kMostProbes spread evenly; in the order of time.
std::vector<ProbeView> probe_views(const PartTask& task, const Part& part, const AdjustedPart& solved,
                                   int tag);

}  // namespace apriltrack
