#include <gtest/gtest.h>

#include "apriltrack/detect/detector.h"
#include "apriltrack/sim/named_scenes.h"
#include "apriltrack/sim/renderer.h"
#include "apriltrack/sim/streaks.h"
#include "corner_statistics.h"

// The whole way: the simulator's picture, with lens, noise and response, and its exact truth.

namespace apriltrack {
namespace {

constexpr double kSharp_px = 2.0;  // of blur

struct Judged {
  test::CornerStatistics sharp;
  int sharp_tags_shown = 0;
  int unknown_tags = 0;
};

Judged judge(const Scene& scene, std::size_t num_frames, std::uint64_t seed) {
  const Renderer renderer(scene, {.seed = seed});
  Detector detector(DetectorOptions{.response = scene.camera.response});
  Judged judged;
  for (std::size_t i = 0; i < num_frames; ++i) {
    const RenderedFrame frame = renderer.render(i * scene.num_frames / num_frames);
    const auto detections = detector.detect(frame.pixels.view());
    for (const Detection& detection : detections) judged.unknown_tags += !scene.map.find(detection.tag);
    for (const TagView& view : tag_views(scene, frame.timestamp)) {
      if (view.blur_px >= kSharp_px) continue;
      ++judged.sharp_tags_shown;
      for (const Detection& detection : detections) {
        if (detection.tag == view.key) judged.sharp.add(detection.corners_px, view.corners_px);
      }
    }
  }
  return judged;
}

void expect_accurate(const Judged& judged, int min_tags) {
  EXPECT_EQ(judged.unknown_tags, 0);
  ASSERT_GE(judged.sharp.num_tags(), min_tags);
  EXPECT_GE(judged.sharp.num_tags(), 0.9 * judged.sharp_tags_shown) << "no tag may be given up to look good";
  EXPECT_LE(std::abs(judged.sharp.radial_bias_px()), test::kMaxBias_px);
  EXPECT_LE(judged.sharp.rms_per_axis_px(), test::kMaxRms_px);
}

TEST(SimulatedAccuracy, TagsOnTheWallsOfARoom) {
  expect_accurate(judge(make_scene("room-gentle", {.texel_m = 0.02}), 20, 601), 45);
}

TEST(SimulatedAccuracy, TagsOnATurningCube) {
  expect_accurate(judge(make_scene("bundle", {.speed = 0.05, .texel_m = 0.02}), 20, 602), 35);
}

TEST(SimulatedAccuracy, ALoneTag) {
  expect_accurate(judge(make_scene("single", {.speed = 0.05, .texel_m = 0.02}), 8, 603), 8);
}

}  // namespace
}  // namespace apriltrack
