#pragma once

#include "apriltrack/sim/sampled_path.h"
#include "apriltrack/sim/scene.h"

namespace apriltrack {

/// What a film of one's own tags by one's own camera needs.
struct MapSceneOptions {
  TagMap map;
  Camera camera;  ///< With a resolution; its line delay must be 0, for rolling shutters are not rendered.
  /// Ego: T_map_camera; joint: T_camera_body.
  SampledPath path;
  TruthKind truth = TruthKind::kEgo;
  double speed = 1.0;  ///< The path that many times faster.
};

/// Every tag as a card of paper of its own, in a painted room round tags and path. Up is where the cameras of
/// the path have it on average, along an axis of the map; with truth kJoint, the cards move before a camera
/// at rest.
///
/// The film takes as long as the path, divided by `speed`; a frame at either end is exposed wholly within it.
/// The rate is the path's own (the median of its steps), 0.01 to 10000 Hz; the exposure is the camera's, else
/// 16 ms, at most the frame interval. Change scene.rate_hz and scene.exposure_s, then call fit_to_path().
Scene make_map_scene(const MapSceneOptions& options);

/// Chooses start_ns and num_frames so that every exposure lies within the path, at the scene's rate and
/// exposure. Throws Error(kInvalidInput) where not one does.
void fit_to_path(Scene& scene);

}  // namespace apriltrack
