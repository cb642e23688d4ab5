#include "turn_watch.h"

#include <gtest/gtest.h>

#include <optional>

#include "apriltrack/geometry/rotation.h"
#include "blur_film.h"

namespace apriltrack::test {
namespace {

/// Two frames of swung_camera(), whose poses and tags are known exactly. The camera turns where it stands.
class WatchedTurn : public ::testing::Test {
 protected:
  static constexpr std::size_t kBefore = 1, kNow = 2;

  WatchedTurn()
      : world_(film_.scene.camera, film_.scene.map, TrackMode::kEgo, 320, 240),
        motion_(MotionNoise(), 0.5),
        watch_(film_.scene.camera.model) {}

  Timestamp time(std::size_t index) const { return film_.frames[index].timestamp; }
  LightPyramid light(std::size_t index) const {
    return light_pyramid(to_linear_light(film_.frames[index].pixels.view(), film_.scene.camera.response),
                         PhotometricWorld::kNumLevels);
  }
  std::optional<SeenTurn> turn_at(std::size_t index) {
    return watch_.turn(time(index), light(index), motion_, world_);
  }
  void remember(const Pose& pose, Timestamp at) {
    MotionBelief belief;
    belief.mean.pose = pose;
    belief.covariance = 1e-4 * Matrix12d::Identity();
    motion_.remember(at, {{belief}});
  }

  const BlurFilm& film_ = swung_camera();
  PhotometricWorld world_;
  MotionMemory motion_;
  TurnWatch watch_;
};

TEST_F(WatchedTurn, IsThatOfTheCameraAndTellsWhereTheTagsWere) {
  EXPECT_FALSE(turn_at(kBefore));  // the first frame
  const Pose before = film_.frames[kBefore].truth;
  remember(before, time(kBefore));
  const auto seen = turn_at(kNow);
  ASSERT_TRUE(seen);
  const Eigen::Quaterniond truth = before.rotation().conjugate() * film_.frames[kNow].truth.rotation();
  EXPECT_GT(rotation_log(truth).norm(), 0.1);
  EXPECT_LT(rotation_log(truth.conjugate() * seen->turn.R_before_now).norm(), 3.0 * seen->turn.sigma_rad);
  Eigen::Vector3d middle_world = Eigen::Vector3d::Zero();
  for (const MapTag& tag : film_.scene.map.tags) middle_world += tag.T_map_tag.translation() / 3.0;
  EXPECT_LT((seen->scene_camera - before.inverse() * middle_world).norm(), 1e-9);
}

TEST_F(WatchedTurn, IsNoneWhereTheMotionIsNotThatOfTheFrameBefore) {
  turn_at(kBefore);
  EXPECT_FALSE(turn_at(kNow));  // nothing is known of the motion
  remember(film_.frames[kBefore].truth, time(kBefore));
  EXPECT_FALSE(turn_at(kNow + 1));  // it is known of two frames ago
}

TEST_F(WatchedTurn, IsNoneWhereNoTagWasInSight) {
  const Pose turned_away(rotation_exp({0.0, 3.0, 0.0}), Eigen::Vector3d::Zero());
  turn_at(kBefore);
  remember(film_.frames[kBefore].truth * turned_away, time(kBefore));
  EXPECT_FALSE(turn_at(kNow));
}

TEST_F(WatchedTurn, IsNoneBeforeTagsThatAreTooNear) {
  // Nearer than 0.1 m any way would look like a large turn.
  for (const double distance_m : {0.09, 0.11}) {
    TagMap map;
    MapTag& tag = map.tags.emplace_back();
    tag.key = {"tag36h11", 3};
    tag.size_m = 0.02;
    tag.T_map_tag = Pose(Eigen::Quaterniond::Identity(), {0.0, 0.0, distance_m});
    PhotometricWorld near_tag(film_.scene.camera, map, TrackMode::kEgo, 320, 240);
    turn_at(kBefore);
    remember(Pose(), time(kBefore));
    EXPECT_EQ(watch_.turn(time(kNow), light(kNow), motion_, near_tag).has_value(), distance_m > 0.1);
  }
}

}  // namespace
}  // namespace apriltrack::test
