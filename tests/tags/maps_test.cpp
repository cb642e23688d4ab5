// The maps that come with the project: each is loaded, and is what its comment says.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "apriltrack/tags/aprilgrid.h"
#include "apriltrack/tags/tag_family.h"
#include "apriltrack/tags/tag_map.h"
#include "support/shared_data.h"

namespace apriltrack {
namespace {

TagMap shipped(const std::string& name) {
  return read_tag_map(test::source_path("maps/" + name));
}

Eigen::Vector3d into_tag(const MapTag& tag) {
  return tag.T_map_tag.rotation() * Eigen::Vector3d::UnitZ();
}

/// Half the edge of the printed square, data cells and white rings outside the detected square included.
double half_print_m(const MapTag& tag) {
  const TagFamily& family = TagFamily::get(tag.key.family);
  return 0.5 * tag.size_m * family.total_width() / family.width_at_border();
}

/// Two printed squares in one plane: apart when a line along an edge of one of them separates them.
bool prints_overlap(const MapTag& a, const MapTag& b, double half_a_m, double half_b_m) {
  const Pose T_a_b = a.T_map_tag.inverse() * b.T_map_tag;
  const double tolerance_m = 1e-9;
  const Eigen::Matrix3d R = T_a_b.rotation_matrix();
  const Eigen::Vector3d t = T_a_b.translation();
  for (int axis = 0; axis < 3; ++axis) {
    const double reach_b = half_b_m * (std::abs(R(axis, 0)) + std::abs(R(axis, 1)));
    if (std::abs(t[axis]) >= (axis < 2 ? half_a_m : 0.0) + reach_b - tolerance_m &&
        std::abs(t[axis]) > tolerance_m) {
      return false;
    }
    const double reach_a = half_a_m * (std::abs(R(0, axis)) + std::abs(R(1, axis)));
    const double offset = std::abs(t.dot(R.col(axis)));
    if (offset >= (axis < 2 ? half_b_m : 0.0) + reach_a - tolerance_m && offset > tolerance_m) return false;
  }
  return true;
}

int count_overlaps(const TagMap& map, double (*half_m)(const MapTag&)) {
  int overlaps = 0;
  for (std::size_t i = 0; i < map.tags.size(); ++i) {
    for (std::size_t k = i + 1; k < map.tags.size(); ++k) {
      overlaps += prints_overlap(map.tags[i], map.tags[k], half_m(map.tags[i]), half_m(map.tags[k]));
    }
  }
  return overlaps;
}

TEST(ShippedMaps, EveryFileOfTheFolderIsTested) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(test::source_path("maps"))) {
    if (entry.path().extension() == ".yaml") names.insert(entry.path().filename().string());
  }
  const std::set<std::string> tested = {"a4_page_6.yaml", "aprilgrid_6x6.yaml", "cube_6.yaml", "room_14.yaml",
                                        "wall_3x4.yaml"};
  EXPECT_EQ(names, tested);
}

TEST(ShippedMaps, OverlapIsSeenWhereThereIsSome) {
  MapTag a;
  a.size_m = 0.08;
  MapTag b = a;
  b.T_map_tag = Pose(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0.0999, 0.05, 0));
  EXPECT_TRUE(prints_overlap(a, b, 0.05, 0.05));
  b.T_map_tag = Pose(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0.1001, 0.05, 0));
  EXPECT_FALSE(prints_overlap(a, b, 0.05, 0.05));
}

TEST(ShippedMaps, CubeShowsATagOnEachFaceOutward) {
  const TagMap map = shipped("cube_6.yaml");
  EXPECT_EQ(map.frame, "body");
  ASSERT_EQ(map.tags.size(), 6u);
  std::set<int> faces;
  for (const MapTag& tag : map.tags) {
    EXPECT_EQ(tag.size_m, 0.07);
    const Eigen::Vector3d centre = tag.T_map_tag.translation();
    int axis = 0;
    centre.cwiseAbs().maxCoeff(&axis);
    faces.insert(centre[axis] > 0 ? axis : axis + 3);
    EXPECT_NEAR(std::abs(centre[axis]), 0.0503, 1e-12) << "on the face, as thick as paper";
    EXPECT_NEAR(into_tag(tag)[axis], centre[axis] > 0 ? -1.0 : 1.0, 1e-12) << "into the cube";
    const double print_over_size = 2.0 * half_print_m(tag) / tag.size_m;
    for (const Eigen::Vector3d& corner : corners_in_map(tag)) {
      const Eigen::Vector3d of_print = centre + print_over_size * (corner - centre);
      EXPECT_NEAR(std::abs(corner[axis]), 0.0503, 1e-12);
      for (const int along : {(axis + 1) % 3, (axis + 2) % 3}) {
        EXPECT_LT(std::abs(corner[along]), 0.044) << "the black border keeps off the edges";
        EXPECT_LT(std::abs(of_print[along]), 0.051) << "no more than a corner of white paper stands out";
      }
    }
  }
  EXPECT_EQ(faces.size(), 6u);
}

TEST(ShippedMaps, RoomHangsItsTagsOnTheWallsFacingInward) {
  const TagMap map = shipped("room_14.yaml");
  EXPECT_EQ(map.frame, "world");
  ASSERT_EQ(map.tags.size(), 14u);
  std::set<std::pair<int, int>> walls;
  for (const MapTag& tag : map.tags) {
    const Eigen::Vector3d centre = tag.T_map_tag.translation();
    const Eigen::Vector3d into = into_tag(tag);
    const int axis = std::abs(into.x()) > 0.5 ? 0 : 1;
    EXPECT_NEAR(std::abs(into[axis]), 1.0, 1e-12) << to_string(tag.key);
    EXPECT_NEAR(centre[axis], into[axis] * ((axis == 0 ? 2.5 : 2.0) - 0.003), 1e-12) << to_string(tag.key);
    walls.insert({axis, into[axis] > 0 ? 1 : -1});
    EXPECT_EQ(tag.size_m, 0.16);
    const Eigen::Vector3d down = tag.T_map_tag.rotation() * Eigen::Vector3d::UnitY();
    EXPECT_LT(down.z(), -std::cos(0.3)) << "hung upright within 17 degrees: " << to_string(tag.key);
    for (const Eigen::Vector3d& corner : corners_in_map(tag)) {
      EXPECT_GT(corner.z(), 0.5);
      EXPECT_LT(corner.z(), 2.5);
    }
  }
  EXPECT_EQ(walls.size(), 4u);
  EXPECT_EQ(count_overlaps(map, half_print_m), 0);
}

TEST(ShippedMaps, WallIsSheetsOfA4EdgeToEdge) {
  const TagMap map = shipped("wall_3x4.yaml");
  EXPECT_EQ(map.frame, "wall");
  ASSERT_EQ(map.tags.size(), 12u);
  for (const MapTag& tag : map.tags) {
    const Eigen::Vector3d expected(0.21 * (tag.key.id % 4), 0.297 * (tag.key.id / 4), 0.0);
    EXPECT_LT((tag.T_map_tag.translation() - expected).norm(), 1e-12) << to_string(tag.key);
    EXPECT_EQ(tag.T_map_tag.rotation().coeffs(), Eigen::Quaterniond::Identity().coeffs());
    EXPECT_EQ(tag.size_m, 0.16);
    EXPECT_LE(half_print_m(tag), 0.5 * 0.21 - 0.005 + 1e-12) << "the printer reaches it";
  }
  EXPECT_EQ(count_overlaps(map, half_print_m), 0);
}

TEST(ShippedMaps, PageFitsA4WithItsQuietZones) {
  const TagMap map = shipped("a4_page_6.yaml");
  ASSERT_EQ(map.tags.size(), 6u);
  for (const MapTag& tag : map.tags) {
    EXPECT_EQ(tag.T_map_tag.rotation().coeffs(), Eigen::Quaterniond::Identity().coeffs());
    EXPECT_EQ(tag.T_map_tag.translation().z(), 0.0);
    EXPECT_LE(std::abs(tag.T_map_tag.translation().x()) + half_print_m(tag), 0.105);
    EXPECT_LE(std::abs(tag.T_map_tag.translation().y()) + half_print_m(tag), 0.1485);
  }
  // White margins may share paper; a black border must not reach into a neighbour's margin.
  const auto half_tag_and_half_margin = [](const MapTag& tag) {
    return 0.5 * (0.5 * tag.size_m + half_print_m(tag));
  };
  EXPECT_EQ(count_overlaps(map, half_tag_and_half_margin), 0);
}

TEST(ShippedMaps, GridIsKalibrsBoard) {
  const TagMap map = shipped("aprilgrid_6x6.yaml");
  const TagMap expected = AprilGrid{}.map();
  EXPECT_EQ(map.frame, expected.frame);
  ASSERT_EQ(map.tags.size(), 36u);
  for (std::size_t i = 0; i < 36; ++i) {
    EXPECT_EQ(map.tags[i].key, expected.tags[i].key);
    EXPECT_EQ(map.tags[i].size_m, 0.088);
    EXPECT_LT((map.tags[i].T_map_tag.matrix() - expected.tags[i].T_map_tag.matrix()).norm(), 1e-12);
  }
  EXPECT_EQ(count_overlaps(map, [](const MapTag& tag) { return 0.5 * tag.size_m; }), 0);
}

}  // namespace
}  // namespace apriltrack
