#pragma once

#include <vector>

#include "apriltrack/base/random.h"
#include "apriltrack/detect/detector.h"
#include "apriltrack/sim/named_scenes.h"
#include "apriltrack/sim/renderer.h"
#include "calibrating.h"
#include "synthetic_world.h"

namespace apriltrack::test {

inline constexpr std::size_t kNumFilmed = 60;  // frames

/// What corners err by here, px per coordinate: as those of other detectors do, which tell no covariance. Our
/// own are so good in rendered pictures that a map can hardly gain from these.
inline constexpr double kFilmedCornerError_px = 0.08;

/// A frame of the scene, with corners and pictures of what is seen.
inline FrameDetections filmed_frame(const Renderer& renderer, std::size_t i) {
  const Scene& scene = renderer.scene();
  DetectorOptions options;
  options.families = {"tag36h11"};
  options.response = scene.camera.response;
  Detector detector(options);
  const RenderedFrame rendered = renderer.render(i * scene.num_frames / kNumFilmed);
  FrameDetections frame{rendered.timestamp, scene.camera.name, detector.detect(rendered.pixels.view())};
  frame.exposure_s = scene.exposure_s;
  RandomStream random(i);
  for (Detection& detection : frame.detections) {
    frame.patches.push_back(*cut_patch(rendered.pixels.view(), detection));
    detection.covariance_px2.reset();
    for (Eigen::Vector2d& corner : detection.corners_px)
      corner += kFilmedCornerError_px * Eigen::Vector2d{random.normal(), random.normal()};
  }
  return frame;
}

/// A slow round past the walls, and the corners and pictures of what is seen.
struct FilmedRoom {
  Scene scene = make_scene("room-gentle", {.texel_m = 0.02});
  std::vector<FrameDetections> frames;
  CameraRig rig;
  CalibrationResult by_corners;

  FilmedRoom() {
    scene.exposure_s = 0.003;
    rig.cameras.push_back(scene.camera);
    const Renderer renderer(scene, {.seed = 733});
    for (std::size_t i = 0; i < kNumFilmed; ++i) frames.push_back(filmed_frame(renderer, i));
    by_corners = calibrate_map(frames, rig, TagSizes(scene.map.tags.front().size_m), {});
  }

  static const FilmedRoom& once() {
    static const FilmedRoom filmed;
    return filmed;
  }
};

}  // namespace apriltrack::test
