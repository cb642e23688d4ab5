#include "apriltrack/tags/map_oddities.h"

#include <gmock/gmock.h>

#include "apriltrack/tags/map_formats.h"
#include "hand_made_layout.h"

namespace apriltrack::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

MapTag tag_at(int id, double x_m, double y_m, double size_m = 0.16) {
  MapTag tag;
  tag.key = {"tag36h11", id};
  tag.size_m = size_m;
  tag.T_map_tag = Pose(Eigen::Quaterniond::Identity(), Eigen::Vector3d(x_m, y_m, 0.0));
  return tag;
}

std::vector<MapOddityKind> kinds_of(const TagMap& map) {
  std::vector<MapOddityKind> kinds;
  for (const MapOddity& oddity : oddities_of(map)) kinds.push_back(oddity.kind);
  return kinds;
}

TagMap map_of_tags(std::vector<MapTag> tags) {
  TagMap map;
  map.tags = std::move(tags);
  return map;
}

TEST(MapOddities, AreNoneOfAWallOfTags) {
  EXPECT_THAT(
      oddities_of(map_of_tags({tag_at(0, 0, 0), tag_at(1, 0.2, 0), tag_at(2, 80, 0), tag_at(3, 0, 0.17)})),
      IsEmpty());
  EXPECT_THAT(oddities_of(map_of_tags({tag_at(0, 0, 0, 1.9)})), IsEmpty());
}

TEST(MapOddities, TellHugeTags) {
  const auto found = oddities_of(map_of_tags({tag_at(0, 0, 0, 6.5), tag_at(1, 20, 0, 0.165)}));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].kind, MapOddityKind::kHugeTags);
  EXPECT_THAT(found[0].tags, ElementsAre(TagKey{"tag36h11", 0}));
  EXPECT_EQ(found[0].value, 6.5);
}

TEST(MapOddities, TellTagsInOnePlace) {
  const auto found = oddities_of(map_of_tags({tag_at(7, 0.03, 0.02), tag_at(1, 5, 0), tag_at(3, 0, 0.02)}));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].kind, MapOddityKind::kOverlappingTags);
  EXPECT_THAT(found[0].tags, ElementsAre(TagKey{"tag36h11", 3}, TagKey{"tag36h11", 7}));
  EXPECT_NEAR(found[0].value, 0.03, 1e-12);
  // Within the empty middle of another, on the back of the same plate, and in a corner of two walls.
  EXPECT_THAT(kinds_of(map_of_tags({tag_at(0, 0, 0, 0.5), tag_at(1, 0, 0, 0.1)})), IsEmpty());
  MapTag other = tag_at(1, 0, 0);
  for (const double turned : {std::numbers::pi, 0.5 * std::numbers::pi}) {
    other.T_map_tag = Pose(Eigen::Quaterniond(Eigen::AngleAxisd(turned, Eigen::Vector3d::UnitX())),
                           Eigen::Vector3d(0.0, 0.0, 0.0));
    EXPECT_THAT(kinds_of(map_of_tags({tag_at(0, 0, 0), other})), IsEmpty()) << turned;
  }
}

TEST(MapOddities, TellPlacesInMillimetresOrInches) {
  EXPECT_THAT(kinds_of(map_of_tags({tag_at(0, 0, 0), tag_at(1, 1500, 0), tag_at(2, 3200, 400)})),
              ElementsAre(MapOddityKind::kFarApart));
  const auto field = [](double unit) {
    std::string tags;
    for (const auto& [id, x] : {std::pair(1, 15.0), {2, 1.0}})
      tags +=
          fmt::format(R"({}{{"ID": {}, "pose": {{"translation": {{"x": {}, "y": {}, "z": 1}}, "rotation": )"
                      R"({{"quaternion": {{"W": 1, "X": 0, "Y": 0, "Z": 0}}}}}}}})",
                      tags.empty() ? "" : ", ", id, x * unit, 4.0 * unit);
    return read_layout(fmt::format(R"({{"tags": [{}], "field": {{"length": 16.5, "width": 8.2}}}})", tags),
                       with_size(0.1651))
        .map;
  };
  EXPECT_THAT(oddities_of(field(1.0)), IsEmpty());
  const auto inches = oddities_of(field(39.37));
  ASSERT_EQ(inches.size(), 2u) << "and far apart";
  EXPECT_EQ(inches[0].kind, MapOddityKind::kOutsideField);
  EXPECT_THAT(inches[0].tags, ElementsAre(TagKey{"tag36h11", 1}, TagKey{"tag36h11", 2}));
  EXPECT_NEAR(inches[0].value, 15.0 * 39.37 - 16.5, 1e-9);
}

}  // namespace
}  // namespace apriltrack::test
