#include "pulling_tags.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "apriltrack/base/random.h"
#include "apriltrack/photometric/light.h"
#include "blur_film.h"

namespace apriltrack::test {
namespace {

/// The first, sharp frame of shaken_camera(): three tags on two walls.
class PullingTags : public ::testing::Test {
 protected:
  PullingTags() {
    fill_light_pyramid(film_.frames[0].frame().image, film_.scene.camera.response,
                       PhotometricWorld::kNumLevels, frame_.photometric.light);
    frame_.photometric.exposure_s = film_.scene.camera.exposure_s.value();
  }
  /// As a tracker would start that took the pose from one tag alone: turned about its centre.
  MotionStart turned_about(const MapTag& tag, const Eigen::Vector3d& turn) const {
    const Pose about =
        tag.T_map_tag *
        Pose(Eigen::Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized())), Eigen::Vector3d::Zero()) *
        tag.T_map_tag.inverse();
    MotionStart start;
    start.state.pose = about * film_.frames[0].truth;
    start.prior.belief = {start.state, 0.01 * Matrix12d::Identity()};
    start.is_cold = false;
    return start;
  }
  double degrees_off(const Explanation& explanation) const {
    return (explanation.fit.state.pose.inverse() * film_.frames[0].truth).log().tail<3>().norm() * 180.0 /
           std::numbers::pi;
  }

  const BlurFilm& film_ = shaken_camera();
  PhotometricWorld world_{film_.scene.camera, film_.scene.map, TrackMode::kEgo, film_.scene.camera.width,
                          film_.scene.camera.height};
  BlurTrackerOptions options_;
  StartFit start_fit_{world_, options_};
  BlurFrame frame_;
};

bool leaves_a_tag_unexplained(const Explanation& explanation) {
  return std::ranges::any_of(explanation.fit.tags,
                             [](const TagEvidence& tag) { return tag.correlation < 0.5; });
}

TEST_F(PullingTags, DoNotHoldThePoseWhereTheyFitByAStripe) {
  RandomStream random(3);
  int num_pulled = 0;
  for (int i = 0; i < 150; ++i) {
    const MapTag& tag = film_.scene.map.tags[static_cast<std::size_t>(i % 3)];
    const Eigen::Vector3d turn =
        0.45 * Eigen::Vector3d{random.normal(), random.normal(), random.normal()}.normalized();
    std::vector<Explanation> found = {start_fit_.explained(frame_, turned_about(tag, turn), {})};
    if (!found.front().is_explained() || !leaves_a_tag_unexplained(found.front())) continue;
    ++num_pulled;
    EXPECT_GT(degrees_off(found.front()), 1.0);
    explain_tags_that_pull(start_fit_, frame_, found);
    EXPECT_LT(degrees_off(found.front()), 0.2) << "start " << i;
  }
  EXPECT_GE(num_pulled, 4);
}

TEST_F(PullingTags, LeaveARightPoseAsItIsWhereOneIsCovered) {
  const Detection& covered = film_.detections[0].at(0);
  GrayImage image = film_.frames[0].pixels;
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& corner : covered.corners_px) {
    for (const double margin_px : {-10.0, 10.0}) box.extend(corner + Eigen::Vector2d::Constant(margin_px));
  }
  for (int y = static_cast<int>(box.min().y()); y <= static_cast<int>(box.max().y()); ++y) {
    for (int x = static_cast<int>(box.min().x()); x <= static_cast<int>(box.max().x()); ++x)
      image(x, y) = x / 3 % 2 == 0 ? 90 : 160;
  }
  fill_light_pyramid(image.view(), film_.scene.camera.response, PhotometricWorld::kNumLevels,
                     frame_.photometric.light);
  const MotionStart start = turned_about(film_.scene.map.tags[0], {0.0, 0.0, 1e-3});
  std::vector<Explanation> found = {start_fit_.explained(frame_, start, {})};
  ASSERT_TRUE(leaves_a_tag_unexplained(found.front()));
  const Pose before = found.front().fit.state.pose;
  explain_tags_that_pull(start_fit_, frame_, found);
  EXPECT_EQ(found.size(), 1U);
  EXPECT_LT((before.inverse() * found.front().fit.state.pose).log().norm(), 1e-12);
  EXPECT_LT(degrees_off(found.front()), 0.3);
}

}  // namespace
}  // namespace apriltrack::test
