#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "initialise/part_adjustment.h"
#include "uncertainty/pose_information.h"

namespace apriltrack {

/// A part at the minimum of its robust cost, linearised there. All views count, each by the weight that
/// Cauchy's loss leaves it: what a clean adjustment rejects is what tells of faults.
struct RobustMap {
  Part part;
  MapState state;
  std::vector<LinearView> views;     ///< Times the root of their weights.
  std::vector<std::size_t> index;    ///< Of each: into Observations::views.
  std::vector<double> root_weights;  ///< Of each.
  /// None where the views leave a pose undetermined. Refers to `views`.
  std::optional<PoseInformation> poses;

  /// near: where the search starts. part: before outliers were removed.
  RobustMap(const PartTask& task, Part part, int held_tag, MapState near);
  RobustMap(const RobustMap&) = delete;
  RobustMap& operator=(const RobustMap&) = delete;

  std::vector<std::size_t> views_of(int tag) const;  ///< Into `views`; in the order of time.
};

}  // namespace apriltrack
