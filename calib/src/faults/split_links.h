#pragma once

#include <vector>

#include "initialise/part_adjustment.h"

namespace apriltrack {

/// A tag that frames show together with another, some of them otherwise than the map has the two.
struct SplitLink {
  int tag = 0, beside = 0;
  std::size_t num_frames = 0;            ///< That show both.
  std::size_t num_frames_elsewhere = 0;  ///< Of these, those that agree in another place of the tag.
  Pose change;                           ///< From where the map has the tag to there.
  std::vector<int> joint;                ///< The tag, with its board: it alone joins others to the map.
};

/// Of tags that alone join others to the map, where some frames that show them with another agree with each
/// other, but not with the map: if they are right, the tag hangs twice or was moved, the map may be folded at
/// it, and nothing else can show it. offered: the views before outliers were removed; kept: those that the
/// map rests on; state: of the map.
std::vector<SplitLink> find_split_links(const PartTask& task, const Part& offered, const Part& kept,
                                        const MapState& state);

}  // namespace apriltrack
