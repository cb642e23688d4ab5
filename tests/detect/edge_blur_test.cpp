// Blur that is measured on tags' edges, against pictures whose blur is known.

#include "apriltrack/detect/edge_blur.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "apriltrack/detect/detector.h"
#include "apriltrack/eval/statistics.h"
#include "apriltrack/sim/named_scenes.h"
#include "apriltrack/sim/renderer.h"
#include "apriltrack/sim/streaks.h"
#include "apriltrack/tags/tag_family.h"
#include "plane_renderer.h"

namespace apriltrack {
namespace {

constexpr double kTagEdge_m = 0.16;
constexpr double kPixelVariance_px2 = 1.0 / 12.0;  // of a pixel's own area

GrayImage film_tag(const test::PlaneView& view, const test::RenderOptions& options) {
  const TagPattern pattern = TagFamily::get("tag36h11").pattern(7);
  const auto brightness = [&](double x, double y) {
    return pattern.brightness(2.0 * x / kTagEdge_m, 2.0 * y / kTagEdge_m);
  };
  return test::render_plane(240, 240, view, brightness, options);
}

/// A tag 90 px wide, turned by `roll_rad`.
test::PlaneView head_on(double roll_rad) {
  constexpr double kFocal_px = 500.0;
  return test::PlaneView(kFocal_px, {119.6, 119.3}, kFocal_px * kTagEdge_m / 90.0, 0.0, 0.0, roll_rad);
}

std::optional<double> measured_sigma_px(const GrayImage& image, const ResponseCurve& response) {
  Detector detector(DetectorOptions{.response = response});
  const auto detections = detector.detect(image.view());
  EXPECT_EQ(detections.size(), 1u);
  if (detections.size() != 1) return std::nullopt;
  return edge_blur_sigma_px(image.view(), response, detections.front());
}

TEST(EdgeBlur, IsTheLensAndThePixelOfAStillTag) {
  for (const double lens_px : {0.5, 0.8, 1.2, 2.0}) {
    for (const double roll_rad : {0.05, 0.4, 0.7}) {
      test::RenderOptions options;
      options.blur_sigma_px = lens_px;
      const auto sigma_px = measured_sigma_px(film_tag(head_on(roll_rad), options), ResponseCurve::srgb());
      ASSERT_TRUE(sigma_px);
      const double true_px = std::sqrt(lens_px * lens_px + kPixelVariance_px2);
      EXPECT_NEAR(*sigma_px, true_px, 0.07 * true_px) << lens_px << " px, roll " << roll_rad;
    }
  }
}

TEST(EdgeBlur, IsTheSameInLinearAndInSrgbPictures) {
  test::RenderOptions options;
  options.blur_sigma_px = 1.0;
  const auto srgb = measured_sigma_px(film_tag(head_on(0.3), options), ResponseCurve::srgb());
  options.is_srgb = false;
  const auto linear = measured_sigma_px(film_tag(head_on(0.3), options), ResponseCurve::linear());
  ASSERT_TRUE(srgb && linear);
  EXPECT_NEAR(*srgb, *linear, 0.03);
}

TEST(EdgeBlur, GrowsWithThePathAcrossAnEdge) {
  constexpr double kLens_px = 0.6;
  for (const double path_px : {3.0, 5.0, 8.0}) {
    test::RenderOptions options;
    options.blur_sigma_px = kLens_px;
    options.motion_px = {path_px, 0.0};
    const auto sigma_px = measured_sigma_px(film_tag(head_on(0.0), options), ResponseCurve::srgb());
    ASSERT_TRUE(sigma_px);
    EXPECT_NEAR(motion_of_blur_px(*sigma_px), path_px, 0.07 * path_px);
  }
}

TEST(EdgeBlur, OfNoMotionIsNone) {
  EXPECT_EQ(motion_of_blur_px(0.3), 0.0);
  EXPECT_NEAR(motion_of_blur_px(std::sqrt(0.25 + 1.0 / 12.0)), 0.0, 1e-6) << "a lens in focus";
}

TEST(EdgeBlur, HasNoneOfATagThatTheImageCuts) {
  const GrayImage image = film_tag(head_on(0.0), {});
  Detection beyond{{"tag36h11", 7}, {}, std::nullopt, std::nullopt};
  beyond.corners_px = {Eigen::Vector2d(200, 290), {290, 290}, {290, 200}, {200, 200}};
  EXPECT_FALSE(edge_blur_sigma_px(image.view(), ResponseCurve::srgb(), beyond));
}

/// Measured over true blur of every tag read in the room, for those of 3 to 9 px.
TEST(EdgeBlur, FollowsTheSimulatorsTruth) {
  const Scene scene = make_scene("room", {.texel_m = 0.02});
  const Renderer renderer(scene, {.seed = 77});
  Detector detector(DetectorOptions{.response = scene.camera.response});
  std::vector<double> ratios;
  for (std::size_t i = 0; i < 60; ++i) {
    const RenderedFrame frame = renderer.render(i * 5);
    const auto detections = detector.detect(frame.pixels.view());
    for (const TagView& view : tag_views(scene, frame.timestamp)) {
      if (view.blur_px < 3.0 || view.blur_px > 9.0) continue;
      for (const Detection& seen : detections) {
        if (seen.tag != view.key) continue;
        const auto sigma_px = edge_blur_sigma_px(frame.pixels.view(), scene.camera.response, seen);
        if (sigma_px) ratios.push_back(motion_of_blur_px(*sigma_px) / view.blur_px);
      }
    }
  }
  ASSERT_GE(ratios.size(), 20u);
  // Of a path oblique to the edges, 0.7 to 1 is across the more blurred pair.
  EXPECT_GT(median(ratios), 0.75);
  EXPECT_LT(median(ratios), 1.1);
  EXPECT_GT(percentile(ratios, 0.05), 0.55);
  EXPECT_LT(percentile(ratios, 0.95), 1.35);
}

}  // namespace
}  // namespace apriltrack
