// How maps are laid on paper, and labels beside their tags.

#include "apriltrack/report/map_elevation.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "apriltrack/report/label_layout.h"

namespace apriltrack {
namespace {

MapTag tag_on_wall(double heading_rad) {
  MapTag tag;
  tag.key = {"tag36h11", 0};
  tag.size_m = 0.16;
  // Upright: y of the tag down, z into a wall that looks along the heading.
  Eigen::Matrix3d R;
  const Eigen::Vector3d into(std::cos(heading_rad), std::sin(heading_rad), 0.0);
  R.col(2) = into;
  R.col(1) = -Eigen::Vector3d::UnitZ();
  R.col(0) = R.col(1).cross(into);
  tag.T_map_tag = Pose(Eigen::Quaterniond(R), Eigen::Vector3d::Zero());
  return tag;
}

TEST(MapElevation, WallsLieAlongTheEdgesOfThePaper) {
  constexpr double kTurn_rad = 0.3;
  TagMap map;
  for (const int quarter : {0, 1, 2})
    map.tags.push_back(tag_on_wall(kTurn_rad + 0.5 * quarter * std::numbers::pi));
  const Elevations all = elevations_of(map, Eigen::Vector3d::UnitZ());
  const double turn = std::atan2(all.above.right.y(), all.above.right.x()) - kTurn_rad;
  EXPECT_NEAR(std::remainder(turn, 0.5 * std::numbers::pi), 0.0, 1e-9);
  EXPECT_NEAR((all.front.up - Eigen::Vector3d::UnitZ()).norm(), 0.0, 1e-12);
  EXPECT_NEAR(all.above.right.dot(all.above.up), 0.0, 1e-12);
}

TEST(MapElevation, PaperHoldsAllPointsWithTheMarginAndYDown) {
  const PaperScale scale({{-1.0, 0.0}, {3.0, 1.0}}, 500.0, 400.0, 50.0);
  EXPECT_DOUBLE_EQ(scale.units_per_m(), 100.0);
  EXPECT_NEAR((scale.at({-1.0, 1.0}) - Eigen::Vector2d(50.0, 50.0)).norm(), 0.0, 1e-9);
  EXPECT_NEAR((scale.at({3.0, 0.0}) - Eigen::Vector2d(450.0, 150.0)).norm(), 0.0, 1e-9);
  EXPECT_NEAR((scale.at(scale.high_m()) - Eigen::Vector2d(scale.width(), 0.0)).norm(), 0.0, 1e-9);
}

TEST(MapElevation, RoundNumbersAreOneTwoOrFive) {
  EXPECT_DOUBLE_EQ(round_number_below(0.99), 0.5);
  EXPECT_DOUBLE_EQ(round_number_below(4.9), 2.0);
  EXPECT_DOUBLE_EQ(round_number_below(10.0), 10.0);
}

TEST(LabelLayout, LabelsOfOnePointDoNotShareAPlace) {
  LabelLayout layout(400.0, 400.0, 13.0);
  const Eigen::Vector2d point(200.0, 200.0), up(0.0, -1.0);
  const Eigen::Vector2d first = layout.place(point, up, "12"), second = layout.place(point, up, "13");
  EXPECT_LT(first.y(), point.y()) << "towards the direction asked for";
  EXPECT_GT((first - second).norm(), 10.0);
}

TEST(LabelLayout, PointsArePushedApartWithinTheirBounds) {
  std::vector<Eigen::Vector2d> points = {{1.0, 1.0}, {1.0, 1.0}, {50.0, 50.0}};
  push_apart(points, 10.0, {0.0, 0.0}, {100.0, 100.0});
  EXPECT_GT((points[0] - points[1]).norm(), 9.9);
  EXPECT_EQ(points[2], Eigen::Vector2d(50.0, 50.0));
  for (const Eigen::Vector2d& point : points) EXPECT_GE(point.minCoeff(), 0.0);
}

}  // namespace
}  // namespace apriltrack
