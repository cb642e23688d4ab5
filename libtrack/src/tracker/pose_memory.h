#pragma once

#include <optional>
#include <vector>

#include "apriltrack/base/timestamp.h"
#include "apriltrack/geometry/pose.h"

namespace apriltrack {

/// What recent frames say of where this one should be: the poses of one track, with the other explanation
/// that could not be ruled out. Poses are of one kind throughout (T_world_camera or T_camera_body).
class PoseMemory {
 public:
  struct Mode {
    Pose pose;
    double weight = 1.0;  ///< 1 for the first mode, the odds for the second.
  };

  /// Poses are remembered this long; after that their prior would be as wide as the ambiguity it should
  /// settle.
  static constexpr double kMaxAge_s = 0.3;

  /// Where each remembered mode should be at `time`: the first moved on with constant velocity where two
  /// poses of it are fresh, the second standing still. Empty when nothing recent is known.
  std::vector<Mode> predict(Timestamp time) const;

  /// log of how well an orientation fits the prediction, 0 at best; the floor leaves room for what no motion
  /// model foresees, so that clear corners can always overrule. 0 for all when nothing recent is known.
  double log_prior(Timestamp time, const Pose& pose) const;

  /// The last pose, not moved on, when it is recent, and its age.
  struct Last {
    Pose pose;
    double age_s = 0.0;
  };
  std::optional<Last> last(Timestamp time) const;

  void remember(Timestamp time, const Pose& pose, const std::optional<Mode>& second);

 private:
  struct Entry {
    Timestamp time;
    std::vector<Mode> modes;
    std::optional<Vector6d> velocity;  ///< Twist per second of the first mode, from the entry before.
  };
  const Entry* recent(Timestamp time) const;

  std::optional<Entry> entry_;
};

}  // namespace apriltrack
