#pragma once

#include <limits>
#include <map>
#include <vector>

#include "model/map_state.h"

namespace apriltrack {

/// Where a group of tags lies that moves as one body, all others held.
struct GroupMotion {
  Pose motion;                    ///< T_map_tag of the group's tags becomes motion * T_map_tag.
  std::map<int, Pose> T_map_rig;  ///< Of the frames that the views are of.
  double cost = 0.0;              ///< Half the robust sum of squares.
};

/// When a fit need not go on.
struct EnoughOfMotion {
  double wanted_cost = std::numeric_limits<double>::infinity();  ///< It creeps too slowly ever to come below.
  std::vector<GroupMotion> minima = {};                          ///< It is about to end in one of these.
};

/// Levenberg-Marquardt on the group's motion and on the poses of the frames, with Cauchy's loss on the views'
/// whitened norms. views: of frames that show tags of the group beside others. group: sorted. start: the
/// motion to start from, and the frames' poses where they are not those of `state`.
GroupMotion fit_group_motion(const Observations& observations, const std::vector<std::size_t>& views,
                             const std::vector<int>& group, const MapState& state, const GroupMotion& start,
                             const EnoughOfMotion& enough = {});

/// What the views cost where the state has the group and the frames.
double cost_of_group(const Observations& observations, const std::vector<std::size_t>& views,
                     const std::vector<int>& group, const MapState& state);

}  // namespace apriltrack
