#include "view_path.h"

#include <algorithm>

namespace apriltrack {

ViewPath::ViewPath(const MotionState& state, double exposure_s, TrackMode mode)
    : state_(state),
      exposure_s_(exposure_s),
      mode_(mode),
      opening_(view_after(-0.5 * exposure_s)),
      middle_(view_after(0.0)),
      closing_(view_after(0.5 * exposure_s)) {}

MapView ViewPath::view_after(double time_s) const {
  const Pose view = camera_from_map(pose_after(state_, time_s), mode_);
  return {view.rotation_matrix(), view.translation(), time_s};
}

std::span<const MapView> ViewPath::instants(double needed) {
  std::size_t which = 0;
  while (which + 1 < kCounts.size() && static_cast<double>(kCounts[which]) < needed) ++which;
  const std::size_t count = kCounts[which];
  std::array<MapView, kMaxInstants>& views = instants_[which];
  if (!is_made_[which]) {
    for (std::size_t m = 0; m < count; ++m) {
      const double share = (static_cast<double>(m) + 0.5) / static_cast<double>(count) - 0.5;
      views[m] = count == 1 ? middle_ : view_after(exposure_s_ * share);
    }
    is_made_[which] = true;
  }
  return std::span(views).first(count);
}

}  // namespace apriltrack
