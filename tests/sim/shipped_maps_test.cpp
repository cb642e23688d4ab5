// maps/ ships the truth of two scenes: digit for digit what the simulator renders.
#include <gtest/gtest.h>

#include "apriltrack/sim/named_scenes.h"
#include "apriltrack/tags/tag_map.h"
#include "support/shared_data.h"

namespace apriltrack {
namespace {

void expect_same(const TagMap& file, const TagMap& scene) {
  EXPECT_EQ(file.frame, scene.frame);
  EXPECT_EQ(file.default_family, scene.default_family);
  ASSERT_EQ(file.tags.size(), scene.tags.size());
  for (std::size_t i = 0; i < scene.tags.size(); ++i) {
    const MapTag& a = file.tags[i];
    const MapTag& b = scene.tags[i];
    SCOPED_TRACE(to_string(b.key));
    EXPECT_EQ(a.key, b.key);
    EXPECT_EQ(a.size_m, b.size_m);
    EXPECT_EQ(a.T_map_tag.translation(), b.T_map_tag.translation());
    // Reading normalises the quaternion, which may move its last digit.
    const Eigen::Vector4d difference = a.T_map_tag.rotation().coeffs() - b.T_map_tag.rotation().coeffs();
    EXPECT_LE(difference.cwiseAbs().maxCoeff(), 4e-16);
  }
}

constexpr double kCoarsestTexel_m = 0.05;  // the walls' paint does not matter here

TEST(ShippedMaps, RoomIsThatOfTheScenes) {
  const TagMap map = read_tag_map(test::source_path("maps/room_14.yaml"));
  expect_same(map, make_scene("room", {.texel_m = kCoarsestTexel_m}).map);
  expect_same(map, make_scene("room-gentle", {.texel_m = kCoarsestTexel_m}).map);
}

TEST(ShippedMaps, CubeIsThatOfTheScene) {
  expect_same(read_tag_map(test::source_path("maps/cube_6.yaml")),
              make_scene("bundle", {.texel_m = kCoarsestTexel_m}).map);
}

}  // namespace
}  // namespace apriltrack
