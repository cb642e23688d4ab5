#pragma once

#include <utility>
#include <vector>

#include "model/map_state.h"
#include "model/solve_context.h"

namespace apriltrack {

/// Some views of one frame, held against the tags of a state, and the frame's pose there, which is theirs to
/// change.
class FrameViews {
 public:
  /// views: of one frame; not empty.
  FrameViews(const PartTask& task, std::vector<std::size_t> views, MapState& state);

  Pose& pose() { return pose_; }
  /// Half the robust sum of squares.
  double cost() const;
  /// Three standard deviations in the mean, or where it cannot be projected.
  bool has_far_view() const;
  /// Downhill by Gauss and Newton, views that are far off counting little. The cost of the best pose on the
  /// way, which is kept.
  double settle();
  /// The best that is found from the poses that the tags' candidates propose one by one, and its cost, which
  /// is infinite where there is none.
  std::pair<double, Pose> best_of_proposals();

 private:
  double squares_of(std::size_t view) const;
  std::vector<Pose> best_proposals();

  const PartTask& task_;
  std::vector<std::size_t> views_;
  MapState& state_;
  Pose& pose_;
};

}  // namespace apriltrack
