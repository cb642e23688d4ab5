#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <utility>

#include "apriltrack/base/random.h"
#include "apriltrack/motion/motion_state.h"
#include "apriltrack/photometric/photometric_world.h"
#include "apriltrack/sim/renderer.h"

namespace apriltrack::test {

/// How a tag stands before the camera, and moves.
struct TagMotion {
  Eigen::Vector3d position_m{0.01, -0.005, 0.5};
  Eigen::Vector3d velocity_m_per_s{0.8, 0.0, 0.0};
  Eigen::Vector3d yaw_pitch_roll_rad{0.2, 0.4, -0.3};
  double yaw_rate_rad_per_s = 2.0;
};

/// What a camera does that nobody told the tracker.
struct ImagingUntold {
  double lens_blur_sigma_px = 0.5;  ///< As it assumes.
  double gamma = 1.0;               ///< Of the light that the response gives back.
};

/// One picture of 160 x 120: a tag of 60 px that slides and turns by up to 8 px during the exposure, unless
/// told otherwise. It is filmed by the simulator, which shares no code with the likelihood; the state is
/// known in closed form.
struct TagPicture {
  static constexpr int kWidth = 160, kHeight = 120;
  static constexpr double kFocal_px = 200.0;
  static constexpr double kDepth_m = 0.5;
  static constexpr double kSize_m = 0.15;
  static constexpr double kExposure_s = 0.02;

  Camera camera{.model = CameraModel({kFocal_px, kFocal_px, 79.5, 59.5}, NoDistortion{})};
  TagMap map;
  MotionState truth;   ///< T_camera_body, the body being the tag.
  Image<float> light;  ///< Without noise; black to white takes about a third of the full scale.

  explicit TagPicture(const TagMotion& moves = {}, const ImagingUntold& imaging = {}) {
    camera.width = kWidth;
    camera.height = kHeight;
    MapTag tag;
    tag.key = {"tag36h11", 5};
    tag.size_m = kSize_m;
    map.tags = {tag};
    Motion motion;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto i = static_cast<Eigen::Index>(axis);
      motion.position_m[axis].offset = moves.position_m[i];
      motion.position_m[axis].rate_per_s = moves.velocity_m_per_s[i];
    }
    motion.yaw_rad.offset = moves.yaw_pitch_roll_rad[0];
    motion.yaw_rad.rate_per_s = moves.yaw_rate_rad_per_s;
    motion.pitch_rad.offset = moves.yaw_pitch_roll_rad[1];
    motion.roll_rad.offset = moves.yaw_pitch_roll_rad[2];
    truth.pose = motion.at(0.0);
    const Eigen::Quaterniond tag_from_camera = truth.pose.rotation().conjugate();
    truth.velocity << tag_from_camera * moves.velocity_m_per_s,
        tag_from_camera * Eigen::Vector3d(0.0, 0.0, moves.yaw_rate_rad_per_s);
    light = filmed(motion, imaging);
  }

  PhotometricFrame frame() const { return frame_of(light); }
  /// The same with white noise; index: of its numbers.
  PhotometricFrame noisy_frame(double sigma, std::uint64_t index) const {
    RandomStream random(7, index, 0);
    Image<float> noisy = light;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) noisy(x, y) += static_cast<float>(sigma * random.normal());
    return frame_of(std::move(noisy));
  }
  PhotometricWorld world() const { return {camera, map, TrackMode::kJoint, kWidth, kHeight}; }

 private:
  Image<float> filmed(const Motion& motion, const ImagingUntold& imaging) const {
    Scene scene;
    scene.truth = TruthKind::kJoint;
    scene.camera = camera;
    scene.map = map;
    scene.formation.vignetting = 0.0;
    scene.formation.lens_blur_sigma_px = imaging.lens_blur_sigma_px;
    Body body{.name = "tag", .T_world_body = motion, .panels = {}};
    add_tags(body, map, {.margin_cells = 0.5});
    scene.bodies = {body};
    Image<float> image = Renderer(scene).sensor_light(Timestamp{0}, kExposure_s);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const auto linear = static_cast<double>(0.2F + 0.5F * image(x, y));
        image(x, y) = static_cast<float>(std::pow(linear, imaging.gamma));
      }
    }
    return image;
  }
  static PhotometricFrame frame_of(Image<float> image) {
    return {light_pyramid(std::move(image), PhotometricWorld::kNumLevels), kExposure_s};
  }
};

}  // namespace apriltrack::test
