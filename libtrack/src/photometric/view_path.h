#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>

#include "apriltrack/motion/motion_state.h"
#include "apriltrack/motion/track_mode.h"

namespace apriltrack {

/// T_camera_map at one instant, as a matrix and an offset.
struct MapView {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
  double time_s;  ///< After the middle of the exposure.

  /// plane: of a tag in the map, (u, v, 1) to a point; from there to a point of the camera frame.
  Eigen::Matrix3d of_plane(const Eigen::Matrix3d& plane) const {
    Eigen::Matrix3d M = rotation * plane;
    M.col(2) += translation;
    return M;
  }
};

/// How the camera sees the map during one exposure: the views that all of a state's tags have in common.
class ViewPath {
 public:
  static constexpr std::size_t kMaxInstants = 16;

  ViewPath(const MotionState& state, double exposure_s, TrackMode mode);

  const MapView& opening() const { return opening_; }  ///< When the shutter opens,
  const MapView& middle() const { return middle_; }
  const MapView& closing() const { return closing_; }  ///< and when it closes.

  /// The middles of equal parts of the exposure: the least number from a short list that is not below
  /// `needed`, at most kMaxInstants. Made when first asked for.
  std::span<const MapView> instants(double needed);

 private:
  static constexpr std::array<std::size_t, 8> kCounts = {1, 2, 3, 4, 6, 8, 12, kMaxInstants};

  MapView view_after(double time_s) const;

  MotionState state_;
  double exposure_s_;
  TrackMode mode_;
  MapView opening_, middle_, closing_;
  std::array<bool, kCounts.size()> is_made_{};
  std::array<std::array<MapView, kMaxInstants>, kCounts.size()> instants_;
};

}  // namespace apriltrack
