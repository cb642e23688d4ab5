#include "apriltrack/tags/tag_map.h"

#include "apriltrack/io/atomic_file.h"
#include "support/pose_matchers.h"
#include "tag_map_support.h"

namespace apriltrack::test {
namespace {

TEST(TagMapYaml, RoundTripsToTheLastBit) {
  RandomStream random(20260101);
  TagMap map;
  map.frame = "body of: the \"drone\" # 2\n";
  map.default_family = "tag36h11";
  map.provenance = {{"tool", "apriltrack 0.1.0"},
                    {"date", "2026-01-02"},
                    {"gauge", "null"},
                    {"held tag", "tag36h11/1"},
                    {"inputs", "a b.mp4, 'c', \\d\t\x01"},
                    {"empty", ""},
                    {"number", "010"},
                    {"accent", "caf\xC3\xA9"}};
  map.extensions = {{"x_lab", "{floor: 3, people: [a, b]}"}, {"x_note", "plain"}};
  for (int id = 0; id < 400; ++id) map.tags.push_back(random_tag(random, id));
  map.tags[3].extensions = {{"x_material", "foam"}, {"x_list", "[1, 2.50, [3]]"}};
  const auto path = test::temporary_folder() / "map.yaml";
  write_tag_map(path, map);
  const TagMap once = read_tag_map(path);
  expect_same(map, once);
  const std::string first_text = read_file(path);
  write_tag_map(path, once);
  EXPECT_EQ(read_file(path), first_text) << "writing what was read must change nothing";
}

TEST(TagMapYaml, ReadsTheContractsExample) {
  const TagMap map = map_from(
      "apriltrack_map: 1                     # schema version\nframe: world\ndefault_family: tag36h11\n"
      "x_site: {name: hall 3, level: 2}\nprovenance: {tool: apriltrack, date: 2026-01-02}\ntags:\n"
      "  - id: 0\n    family: tag25h9\n    size: 0.16\n    pose:\n      position: {x: 1, y: 2, z: 3}\n"
      "      orientation: {x: 0.0, y: 0.0, z: 0.6, w: 0.8}\n    x_note: on the door\n"
      "    statistics: {views: 12, residual_rms_px: 0.25, flags: [weak]}\n"
      "  - {id: 586, size: 1e-1, pose: {position: {x: 0, y: 0, z: 0}, orientation: {x: 0, y: 0, z: 0, w: "
      "1}}}\n");
  EXPECT_EQ(map.frame, "world");
  ASSERT_EQ(map.tags.size(), 2u);
  EXPECT_EQ(map.tags[0].key, (TagKey{"tag25h9", 0}));
  EXPECT_EQ(map.tags[1].key, (TagKey{"tag36h11", 586}));
  EXPECT_EQ(map.tags[1].size_m, 0.1);
  const Pose expected(
      Eigen::AngleAxisd(2.0 * std::atan2(0.6, 0.8), Eigen::Vector3d::UnitZ()).toRotationMatrix(),
      Eigen::Vector3d(1, 2, 3));
  EXPECT_THAT(map.tags[0].T_map_tag, test::PoseNear(expected, 1e-15, 1e-7));
  EXPECT_EQ(map.tags[0].statistics->views, 12);
  EXPECT_EQ(map.tags[0].statistics->flags, std::vector<std::string>{"weak"});
  ASSERT_EQ(map.extensions.size(), 1u);
  EXPECT_EQ(map.extensions[0].first, "x_site");
  EXPECT_EQ(map.tags[0].extensions[0].first, "x_note");
  ASSERT_EQ(map.provenance.size(), 2u);
  EXPECT_EQ(map.provenance[1], (std::pair<std::string, std::string>("date", "2026-01-02")));
}

TEST(TagMapYaml, NormalisesWhatRoundingLeft) {
  const TagMap map = map_from(with_orientation("{x: 0, y: 0, z: 0.7075, w: 0.7075}"));  // length 1.00056
  EXPECT_NEAR(map.tags[0].T_map_tag.rotation().norm(), 1.0, 1e-15);
  EXPECT_NEAR(map.tags[0].T_map_tag.rotation().z(), std::sqrt(0.5), 1e-15);
}

TEST(TagMapYaml, SameIdOfAnotherFamilyIsAnotherTag) {
  const TagMap map =
      map_from(one_tag("7", "0.16", kPose + "  - id: 7\n    family: tag25h9\n    size: 0.1\n" + kPose));
  EXPECT_EQ(map.find({"tag36h11", 7})->size_m, 0.16);
  EXPECT_EQ(map.find({"tag25h9", 7})->size_m, 0.1);
  EXPECT_EQ(map.find({"tag16h5", 7}), nullptr);
}

TEST(TagMap, CornersAreInTheMapFrameAndCornerOrder) {
  // Turned by 90 degrees about z: x of the tag points along y of the map, y of the tag along -x.
  MapTag tag;
  tag.size_m = 0.2;
  tag.T_map_tag = Pose(Eigen::Quaterniond(std::sqrt(0.5), 0, 0, std::sqrt(0.5)), Eigen::Vector3d(1, 2, 3));
  const auto corners = corners_in_map(tag);
  const Eigen::Vector3d expected[] = {{0.9, 1.9, 3}, {0.9, 2.1, 3}, {1.1, 2.1, 3}, {1.1, 1.9, 3}};
  for (int i = 0; i < 4; ++i) EXPECT_LT((corners[i] - expected[i]).norm(), 1e-15) << i;
}

TEST(TagMapYaml, ReadsEveryRecordedMap) {
  APRILTRACK_SHARED_OR_SKIP(data, "data");
  int read = 0;
  for (const auto& folder : std::filesystem::directory_iterator(data)) {
    for (const char* name : {"map.yaml", "reference_map.yaml"}) {
      const auto path = folder.path() / name;
      if (!std::filesystem::exists(path)) continue;
      const TagMap map = read_tag_map(path);
      const auto copy = test::temporary_folder() / "copy.yaml";
      write_tag_map(copy, map);
      expect_same(map, read_tag_map(copy));
      ++read;
    }
  }
  EXPECT_GE(read, 11);
}

}  // namespace
}  // namespace apriltrack::test
