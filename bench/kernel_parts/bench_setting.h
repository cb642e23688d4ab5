#pragma once

#include <hwy/highway.h>

#include <algorithm>
#include <cstdint>
#include <ctime>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "apriltrack/base/random.h"
#include "apriltrack/geometry/rotation.h"
#include "apriltrack/photometric/joint_likelihood.h"
#include "tag_prediction.h"

/// What bench_kernels has its kernels look at, and how it times them.
namespace apriltrack::bench {

inline constexpr std::size_t kNumHypotheses = 3000;
inline constexpr std::size_t kNumWithPattern = 300;  // the definition takes a tenth of a millisecond for each
inline constexpr double kTagSize_m = 0.16, kFocal_px = 800.0;
inline constexpr int kWidth = 1280, kHeight = 720;
inline constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();

/// A way of computing the same, under its name.
struct Way {
  std::string name;
  std::int64_t instruction_set = 0;  ///< 0: as the machine chooses.
  std::function<void()> run;
  std::vector<double> seconds;

  double median_s() const {
    std::vector<double> sorted = seconds;
    std::ranges::sort(sorted);
    return sorted[sorted.size() / 2];
  }
};

inline void take_turns(std::vector<Way>& ways, int repetitions) {
  for (int repetition = 0; repetition <= repetitions; ++repetition) {
    for (Way& way : ways) {
      hwy::SetSupportedTargetsForTest(way.instruction_set);
      const std::clock_t start = std::clock();  // processor time: others may use the machine meanwhile
      way.run();
      const double taken_s = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
      if (repetition > 0) way.seconds.push_back(taken_s);  // the first warms up
    }
  }
  hwy::SetSupportedTargetsForTest(0);
}

inline std::vector<std::int64_t> instruction_sets() {
  hwy::SetSupportedTargetsForTest(0);
  std::vector<std::int64_t> sets;
  // What the library was built for; its way without SIMD has a line of its own.
  for (std::int64_t left = hwy::SupportedTargets() & HWY_TARGETS & ~HWY_SCALAR & ~HWY_EMU128; left != 0;
       left &= left - 1)
    sets.push_back(left & -left);
  std::ranges::reverse(sets);  // the best comes last
  return sets;
}

/// A tag of so many pixels before a camera, and hypotheses within some pixels and degrees of the truth.
struct Setting {
  explicit Setting(double tag_px) {
    camera.width = kWidth;
    camera.height = kHeight;
    MapTag tag;
    tag.key = {"tag36h11", 5};
    tag.size_m = kTagSize_m;
    map.tags = {tag};
    RandomStream random(static_cast<std::uint64_t>(tag_px));
    frame.exposure_s = 0.01;
    const double distance_m = kFocal_px * kTagSize_m / tag_px, pixel_m = distance_m / kFocal_px;
    for (std::size_t i = 0; i < kNumHypotheses; ++i) {
      MotionState state;
      const Eigen::Vector3d turn(0.1 + 0.05 * random.normal(), 0.4 + 0.05 * random.normal(), 0.3);
      state.pose = {rotation_exp(turn),
                    Eigen::Vector3d(8.0 * random.normal(), 8.0 * random.normal(), 0.0) * pixel_m +
                        Eigen::Vector3d(0.0, 0.0, distance_m)};
      // 9 pixels in an exposure: eight instants.
      const double speed = 9.0 * pixel_m / frame.exposure_s;
      state.velocity.head<3>() = state.pose.rotation().conjugate() * Eigen::Vector3d(speed, 0.0, 0.0);
      hypotheses.push_back(state);
      views.push_back(camera_from_tag_plane(state.pose, kTagSize_m));
    }
    film(random);
    reference.resize(grid.num_samples());
    sample_patch(frame.light[0].view(), camera.model, views[0], grid, reference);
  }

  /// The first hypothesis' view of the tag on a grey ground, with noise.
  void film(RandomStream& random) {
    PhotometricWorld world(camera, map, TrackMode::kJoint, kWidth, kHeight);
    ViewPath path(hypotheses[0], frame.exposure_s, world.mode);
    const TagPrediction truth(world, world.tags[0], path, 0);
    Image<float> light(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const PixelPrediction seen = truth.predict(world.rays.level(0)(x, y));
        light(x, y) = 0.55F * seen.light + 0.08F * seen.presence + 0.3F * (1.0F - seen.presence) +
                      static_cast<float>(0.01 * random.normal());
      }
    }
    frame.light.push_back(std::move(light));
  }

  Camera camera{.model = CameraModel({kFocal_px, kFocal_px, 640.0, 360.0}, NoDistortion{})};
  TagMap map;
  PatchGrid grid;
  PhotometricFrame frame;
  std::vector<MotionState> hypotheses;
  std::vector<Eigen::Matrix3d> views;
  std::vector<double> reference;
};

/// What bench_kernels prints, part by part.
void bench_patches(double tag_px, bool has_pattern, int repetitions);
void bench_limits(int repetitions);
void bench_pixels(int repetitions);

}  // namespace apriltrack::bench
