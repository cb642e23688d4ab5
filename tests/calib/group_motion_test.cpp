// How a group of tags moves as one body to where the views have it, and when that need not be followed to the
// end.
#include "solve/group_motion.h"

#include <gtest/gtest.h>

#include "adjusted_world.h"
#include "apriltrack/base/degrees.h"
#include "apriltrack/geometry/rotation.h"
#include "calibrating.h"
#include "initialise/hinge.h"

namespace apriltrack {
namespace {

using test::AdjustedWorld;

/// A room of noisy corners, and one of its tags that is asked for.
class GroupMotionTest : public ::testing::Test {
 protected:
  GroupMotionTest() : room_(noisy_room()) {
    const ViewIndex index(room_.observations, room_.solved.part);
    views_ = find_hinge(room_.observations, index, group_).views;
  }

  GroupMotion fit(const GroupMotion& start, const EnoughOfMotion& enough = {}) const {
    return fit_group_motion(room_.observations, views_, group_, room_.solved.state, start, enough);
  }

  /// The tag turned where it is, about its own x axis.
  GroupMotion turned(double angle_rad) const {
    const Pose& T_map_tag = room_.solved.state.T_map_tag[static_cast<std::size_t>(group_.front())];
    Vector6d turn = Vector6d::Zero();
    turn[3] = angle_rad;
    return {T_map_tag * Pose::exp(turn) * T_map_tag.inverse(), {}, 0.0};
  }

  static AdjustedWorld noisy_room() {
    const test::SyntheticWorld world = test::make_room(8, 40, test::perspective_camera());
    std::vector<FrameDetections> frames = test::exact_detections(world);
    RandomStream random(71);
    test::add_noise(frames, 0.1, random);
    return {world, frames};
  }

  AdjustedWorld room_;
  std::vector<int> group_ = {3};
  std::vector<std::size_t> views_;
};

double apart_rad(const GroupMotion& a, const GroupMotion& b) {
  return rotation_angle_rad(a.motion.rotation(), b.motion.rotation());
}

TEST_F(GroupMotionTest, ATurnedTagComesBackToItsMinimum) {
  const GroupMotion now = fit({});
  const GroupMotion back = fit(turned(10.0 * kRadPerDeg));
  ASSERT_GT(cost_of_group(room_.observations, views_, group_, room_.solved.state), 0.0);
  EXPECT_NEAR(back.cost, now.cost, 1e-3 * now.cost);
  EXPECT_LT(apart_rad(back, now), 0.01 * kRadPerDeg);
}

TEST_F(GroupMotionTest, EndsWhereItFallsIntoAKnownMinimum) {
  const GroupMotion now = fit({});
  const GroupMotion early = fit(turned(10.0 * kRadPerDeg), {.minima = {now}});
  EXPECT_GT(early.cost, fit(turned(10.0 * kRadPerDeg)).cost) << "it went on to the end";
  EXPECT_LT(early.cost, now.cost + 1.0);
  EXPECT_LT(apart_rad(early, now), 1.0 * kRadPerDeg);
}

TEST_F(GroupMotionTest, GoesOnWhereAKnownMinimumCostsElseOrLiesElsewhere) {
  const GroupMotion start = turned(10.0 * kRadPerDeg), to_the_end = fit(start);
  GroupMotion costlier = fit({}), turned_away = costlier;
  costlier.cost += 50.0;
  turned_away.motion = turned(4.0 * kRadPerDeg).motion;
  const GroupMotion found = fit(start, {.minima = {costlier, turned_away}});
  EXPECT_EQ(found.cost, to_the_end.cost);
  EXPECT_EQ(found.motion.matrix(), to_the_end.motion.matrix());
}

}  // namespace
}  // namespace apriltrack
