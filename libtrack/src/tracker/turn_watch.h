#pragma once

#include <optional>

#include "apriltrack/base/timestamp.h"
#include "apriltrack/photometric/photometric_world.h"
#include "apriltrack/photometric/visual_gyroscope.h"
#include "motion_memory.h"
#include "seen_turn.h"

namespace apriltrack {

/// Sees how the camera turns from frame to frame of one recording, by the whole scene: of a camera among
/// things at rest (ego mode). What a body before a camera does is not seen in the scene.
class TurnWatch {
 public:
  explicit TurnWatch(const CameraModel& model) : gyroscope_(model) {}

  /// Since the frame of the call before. motion: up to that frame; none is seen where it tells nothing of it,
  /// or no tag of the map was in sight then.
  std::optional<SeenTurn> turn(Timestamp time, const LightPyramid& light, const MotionMemory& motion,
                               PhotometricWorld& world);

 private:
  VisualGyroscope gyroscope_;
  Timestamp last_time_;
};

}  // namespace apriltrack
