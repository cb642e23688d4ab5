#include "motion_start.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "apriltrack/base/random.h"
#include "apriltrack/geometry/rotation.h"

namespace apriltrack {
namespace {

const Pose kMapFromTag(rotation_exp({0.3, -0.5, 0.2}), {0.4, 0.1, -0.2});

/// A tag some two metres ahead and aside, tilted any way, in any motion.
MotionState any_state(RandomStream& random, TrackMode mode) {
  const auto vector = [&](double scale) -> Eigen::Vector3d {
    return scale * Eigen::Vector3d{random.normal(), random.normal(), random.normal()};
  };
  const Pose T_camera_tag(rotation_exp(vector(0.4)), Eigen::Vector3d(0.3, -0.4, 2.0) + vector(0.2));
  MotionState state;
  state.pose = pose_from_camera(T_camera_tag * kMapFromTag.inverse(), mode);
  state.velocity << vector(0.5), vector(2.0);
  return state;
}

Pose tag_after(const MotionState& state, double dt_s, TrackMode mode) {
  return camera_from_map(pose_after(state, dt_s), mode) * kMapFromTag;
}

class MirroredState : public ::testing::TestWithParam<TrackMode> {};
INSTANTIATE_TEST_SUITE_P(Modes, MirroredState, ::testing::Values(TrackMode::kEgo, TrackMode::kJoint),
                         [](const auto& mode) { return mode.param == TrackMode::kEgo ? "Ego" : "Joint"; });

TEST_P(MirroredState, MovesTheTagsCentreAsBeforeAndTurnsItsPictureAsBefore) {
  constexpr double kStep_s = 1e-6;
  RandomStream random(1);
  for (int i = 0; i < 20; ++i) {
    const MotionState state = any_state(random, GetParam());
    const MotionState other = mirrored_state(state, kMapFromTag, GetParam());
    const Pose tag = tag_after(state, 0.0, GetParam()), mirrored = tag_after(other, 0.0, GetParam());
    EXPECT_LT((mirrored.translation() - tag.translation()).norm(), 1e-9);
    // Differences of places a moment later, by the motion model itself.
    const Pose tag_later = tag_after(state, kStep_s, GetParam()),
               mirrored_later = tag_after(other, kStep_s, GetParam());
    EXPECT_LT((mirrored_later.translation() - tag_later.translation()).norm(), 1e-3 * kStep_s) << i;
    const auto turn = [&](const Pose& from, const Pose& to) -> Eigen::Vector3d {
      return rotation_log(to.rotation() * from.rotation().conjugate()) / kStep_s;
    };
    const Eigen::Vector3d sight = tag.translation().normalized();
    const Eigen::Vector3d of_tag = turn(tag, tag_later), of_mirrored = turn(mirrored, mirrored_later);
    EXPECT_NEAR(of_mirrored.dot(sight), of_tag.dot(sight), 1e-3) << i;
    EXPECT_LT((of_mirrored + of_tag - 2.0 * of_tag.dot(sight) * sight).norm(), 1e-3) << i;
  }
}

TEST_P(MirroredState, TwiceIsTheStateItself) {
  RandomStream random(2);
  const MotionState state = any_state(random, GetParam());
  const MotionState twice =
      mirrored_state(mirrored_state(state, kMapFromTag, GetParam()), kMapFromTag, GetParam());
  EXPECT_LT(difference(state, twice).norm(), 1e-9);
}

}  // namespace
}  // namespace apriltrack
