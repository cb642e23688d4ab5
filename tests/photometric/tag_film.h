#pragma once

#include "apriltrack/geometry/rotation.h"
#include "apriltrack/motion/motion_state.h"
#include "apriltrack/photometric/photometric_world.h"
#include "apriltrack/sim/motion.h"
#include "apriltrack/sim/renderer.h"

namespace apriltrack::test {

/// The motion's state at time 0, by central differences.
inline MotionState state_of(const Motion& motion) {
  constexpr double kStep_s = 1e-4;
  const Pose before = motion.at(-kStep_s), after = motion.at(kStep_s);
  MotionState state;
  state.pose = motion.at(0.0);
  const Eigen::Quaterniond body_from_camera = state.pose.rotation().conjugate();
  state.velocity << body_from_camera * (after.translation() - before.translation()),
      rotation_log(before.rotation().conjugate() * after.rotation());
  state.velocity /= 2.0 * kStep_s;
  return state;
}

/// A tag of 16 cm, tag36h11 5, that moves before a camera of 320 x 240 pixels, filmed once at time 0 by the
/// renderer, which shares no code with the likelihood.
struct TagFilm {
  static constexpr double kExposure_s = 0.02;
  static constexpr double kSize_m = 0.16;

  Camera camera;
  TagMap map;
  MotionState truth;  ///< T_camera_body and its velocity.
  PhotometricFrame frame;

  TagFilm(const CameraModel& model, const Motion& motion) : camera{.model = model}, truth(state_of(motion)) {
    camera.width = 320;
    camera.height = 240;
    MapTag tag;
    tag.key = {"tag36h11", 5};
    tag.size_m = kSize_m;
    map.tags = {tag};
    Scene scene;
    scene.truth = TruthKind::kJoint;
    scene.camera = camera;
    scene.camera.exposure_s = kExposure_s;
    scene.formation.vignetting = 0.0;
    scene.map = map;
    Body body{.name = "tag", .T_world_body = motion, .panels = {}};
    add_tags(body, map, {.margin_cells = 0.5});
    scene.bodies = {body};
    const Renderer renderer(scene);
    frame.light =
        light_pyramid(renderer.sensor_light(Timestamp{0}, kExposure_s), PhotometricWorld::kNumLevels);
    frame.exposure_s = kExposure_s;
  }

  PhotometricWorld world(TrackMode mode = TrackMode::kJoint) const { return {camera, map, mode, 320, 240}; }
};

}  // namespace apriltrack::test
