#include <gtest/gtest.h>

#include "apriltrack/tags/tag_family.h"
#include "apriltrack/tracker/localizer.h"
#include "detect/plane_renderer.h"
#include "side_by_side.h"
#include "tracker/synthetic_world.h"

namespace apriltrack {
namespace {

constexpr std::size_t kThreads = 4;

void expect_equal(const std::vector<TrackResult>& found, const std::vector<TrackResult>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    SCOPED_TRACE("frame " + std::to_string(i));
    ASSERT_TRUE(expected[i].pose) << expected[i].reason;
    ASSERT_TRUE(found[i].pose) << found[i].reason;
    EXPECT_EQ(found[i].pose->matrix(), expected[i].pose->matrix());
    EXPECT_EQ(*found[i].covariance, *expected[i].covariance);
    EXPECT_EQ(found[i].tags_tracked, expected[i].tags_tracked);
    EXPECT_EQ(found[i].second_mode_odds, expected[i].second_mode_odds);
  }
}

/// Camera and map are shared by all threads; each has a localizer, a path and noise of its own.
TEST(LocalizersSideBySide, GiveTheSameAsOneByOne) {
  const Camera camera = test::camera_with(RadtanDistortion({-0.28, 0.09, 5e-4, -3e-4}));
  const TagMap map = test::room();
  const auto work = [&](std::size_t thread) {
    RandomStream random(411, thread);
    Localizer localizer(camera, map);
    std::vector<TrackResult> results;
    for (std::int64_t i = 0; i < 25; ++i) {
      const Pose T_camera_map = test::random_T_map_camera(random).inverse();
      // Every third frame shows a lone tag, whose pose hangs on what the localizer remembers.
      const TagMap seen = i % 3 == 2 ? test::only(map, {2}) : map;
      results.push_back(localizer.localize(
          test::with_noise(test::seen(camera, seen, T_camera_map, {i * 33'000'000}), random, 0.3)));
    }
    return results;
  };
  const auto together = test::side_by_side(kThreads, work);
  const auto alone = test::one_by_one(kThreads, work);
  for (std::size_t thread = 0; thread < kThreads; ++thread) expect_equal(together[thread], alone[thread]);
  EXPECT_NE(alone[0][0].pose->matrix(), alone[1][0].pose->matrix()) << "each thread has work of its own";
}

/// From pictures: each builds its detector's tables at its first frame.
TEST(LocalizersSideBySide, GiveTheSameFromPictures) {
  constexpr int kImageSide_px = 120;
  constexpr double kFocal_px = 300.0;
  Camera camera{.model = CameraModel({kFocal_px, kFocal_px, 59.5, 59.5}, NoDistortion{})};
  camera.width = camera.height = kImageSide_px;
  camera.exposure_s = 0.0;
  TagMap map;
  for (int id = 0; id < 8; ++id) map.tags.push_back(test::tag_at(id, Pose()));

  const auto work = [&](std::size_t thread) {
    const TagPattern pattern = TagFamily::get("tag36h11").pattern(static_cast<int>(thread));
    const auto picture = [&](double x, double y) {
      return pattern.brightness(2.0 * x / test::kTagSize_m, 2.0 * y / test::kTagSize_m);
    };
    Localizer localizer(camera, map);
    std::vector<TrackResult> results;
    for (std::int64_t i = 0; i < 3; ++i) {
      const test::PlaneView view(kFocal_px, {59.0, 60.0}, kFocal_px * test::kTagSize_m / 60.0, 0.8, 1.1,
                                 0.05 * static_cast<double>(i));
      const GrayImage image =
          test::render_plane(kImageSide_px, kImageSide_px, view, picture, {.samples = 2, .seed = thread + 1});
      results.push_back(
          localizer.localize({.image = image.view(), .timestamp = {i * 33'000'000}, .exposure_s = 0.0}));
    }
    return results;
  };
  const auto together = test::side_by_side(kThreads, work);
  const auto alone = test::one_by_one(kThreads, work);
  for (std::size_t thread = 0; thread < kThreads; ++thread) expect_equal(together[thread], alone[thread]);
}

}  // namespace
}  // namespace apriltrack
