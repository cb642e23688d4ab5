#include "uncertainty/noise_scale.h"

#include <gtest/gtest.h>

#include <numeric>

#include "solve/bundle_adjustment.h"
#include "synthetic_world.h"

// How large the noise is, found in residuals about the true tags.

namespace apriltrack {
namespace {

using test::SyntheticWorld;

struct Seen {
  Observations observations;
  MapState state;
  std::vector<std::size_t> views;
};

/// Tags at the truth; frames follow the noise, as they do in every fit.
Seen seen(const SyntheticWorld& world, const std::vector<FrameDetections>& frames) {
  UnusedDetections unused;
  Seen result{collect_observations(frames, world.rig, world.sizes(), {}, unused), {}, {}};
  for (const TagKey& tag : result.observations.tags)
    result.state.T_map_tag.push_back(world.map.find(tag)->T_map_tag);
  result.state.T_map_rig = world.T_world_rig;
  result.state.cameras = result.observations.cameras;
  result.views.resize(result.observations.views.size());
  std::iota(result.views.begin(), result.views.end(), std::size_t{0});
  EXPECT_TRUE(adjust(result.observations, result.views, {}, {}, result.state).is_usable);
  return result;
}

TEST(NoiseScale, TellsErrorsThatAnEdgesEndsShareFromThoseThatTheyDoNot) {
  const SyntheticWorld world = test::make_room(12, 200, test::perspective_camera());
  std::vector<FrameDetections> frames = test::exact_detections(world);
  RandomStream random(5);
  // Expected are 0.15 px and -0.45. The variance of a sum of two ends is 2 sigma^2 (1 + rho), of a difference
  // 2 sigma^2 (1 - rho).
  constexpr double kSigma_px = 0.3, kCorrelation = 0.6;
  test::add_edge_noise(frames, kSigma_px, kCorrelation, random);
  const Seen all = seen(world, frames);
  const NoiseScale noise = measure_noise(all.observations, all.views, all.state);
  const double sum = kSigma_px / 0.15 * std::sqrt((1.0 + kCorrelation) / (1.0 - 0.45));
  const double difference = kSigma_px / 0.15 * std::sqrt((1.0 - kCorrelation) / (1.0 + 0.45));
  EXPECT_NEAR(noise.sum, sum, 0.1 * sum);
  EXPECT_NEAR(noise.difference, difference, 0.1 * difference);
}

TEST(NoiseScale, KnowsTheNoisyFrames) {
  const SyntheticWorld world = test::make_room(12, 120, test::perspective_camera());
  std::vector<FrameDetections> frames = test::exact_detections(world), noisy = frames;
  RandomStream random(6);
  test::add_edge_noise(frames, 0.1, -0.45, random);
  test::add_edge_noise(noisy, 0.5, -0.45, random);
  for (std::size_t i = 0; i < frames.size(); i += 5) frames[i] = noisy[i];
  Seen all = seen(world, frames);
  all.state.noise = measure_noise(all.observations, all.views, all.state);
  const std::vector<double> scales = measure_frame_noise(all.observations, all.views, all.state);
  for (std::size_t i = 0; i < scales.size(); ++i) {
    if (i % 5 == 0) {
      EXPECT_GT(scales[i], 1.2) << i;
    } else {
      EXPECT_LT(scales[i], 1.0) << i;
    }
  }
}

TEST(NoiseScale, TakesFramesForEqualThatDifferByChanceOnly) {
  const SyntheticWorld world = test::make_room(12, 120, test::perspective_camera());
  std::vector<FrameDetections> frames = test::exact_detections(world);
  RandomStream random(7);
  test::add_edge_noise(frames, 0.2, -0.45, random);
  Seen all = seen(world, frames);
  all.state.noise = measure_noise(all.observations, all.views, all.state);
  for (const double scale : measure_frame_noise(all.observations, all.views, all.state))
    EXPECT_NEAR(scale, 1.0, 0.1);
}

}  // namespace
}  // namespace apriltrack
