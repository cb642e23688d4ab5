#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <optional>

#include "apriltrack/camera/camera_model.h"
#include "apriltrack/photometric/light.h"

namespace apriltrack {

/// How a camera has turned from one frame to the next.
struct CameraTurn {
  Eigen::Quaterniond R_before_now = Eigen::Quaterniond::Identity();
  /// Of each number of a small rotation on the right: what the pictures leave open, and what they show of
  /// things near and far while the camera goes.
  double sigma_rad = 0.0;
};

/// Tells a camera's turn between frames by the whole scene, tags or not, from pictures so small that blur
/// hardly shows in them (Klein, Murray, "Improving the agility of keyframe-based SLAM", ECCV 2008, section
/// 4): the shift of pictures of 40 pixels that correlates best, among all that leave them enough in common,
/// and from there a turn about three axes, fitted on twice as many (docs/algorithms/blur_tracker.md, section
/// 4).
///
/// Rough, but without any expectation that could be wrong: after a reversal it tells as much as in a steady
/// turn. What the camera has gone looks like a turn, too, and is no part of sigma_rad.
class VisualGyroscope {
 public:
  explicit VisualGyroscope(const CameraModel& model);
  ~VisualGyroscope();
  VisualGyroscope(VisualGyroscope&&) noexcept;
  VisualGyroscope& operator=(VisualGyroscope&&) noexcept;

  /// Since the frame of the call before. None at the first frame, after one of another size, where images are
  /// too small, and where the two do not resemble each other: in the dark, or where it is not one scene at
  /// rest that is seen.
  /// light: of three levels at least.
  std::optional<CameraTurn> turn(const LightPyramid& light);
  void forget();

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace apriltrack
