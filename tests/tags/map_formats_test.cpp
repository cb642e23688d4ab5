// What holds for every format: round trips through each pair, recognition by content, hostile content.
#include "apriltrack/tags/map_formats.h"

#include <algorithm>

#include "apriltrack/base/random.h"
#include "apriltrack/io/atomic_file.h"
#include "apriltrack/tags/aprilgrid.h"
#include "hand_made_layout.h"

namespace apriltrack::test {
namespace {

constexpr double kSame_m = 1e-9, kSame_rad = 1e-9;

/// Quaternions that formulas stumble over: half turns, angles at the poles, next to them.
std::vector<Eigen::Quaterniond> awkward_rotations() {
  const auto about = [](double angle, const Eigen::Vector3d& axis) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis.normalized()));
  };
  std::vector<Eigen::Quaterniond> rotations = {Eigen::Quaterniond::Identity(), Eigen::Quaterniond(0, 1, 0, 0),
                                               Eigen::Quaterniond(0, 0, 1, 0),
                                               Eigen::Quaterniond(0, 0, 0, -1)};
  for (const double pole : {0.5 * std::numbers::pi, -0.5 * std::numbers::pi}) {
    for (const double off : {0.0, 1e-12, -1e-9, 1e-7, 1e-5}) {
      for (const Eigen::Vector3d& axis :
           {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, 0, 1)})
        rotations.push_back(about(0.3, {0, 0, 1}) * about(pole + off, axis) * about(-0.7, {1, 0, 0}));
    }
  }
  return rotations;
}

MapTag tag_with(int id, const Eigen::Quaterniond& rotation, RandomStream& random) {
  const Eigen::Vector3d at{random.uniform(-20, 20), random.uniform(-20, 20), random.uniform(-3, 3)};
  return map_tag("tag36h11", id, 0.1651, Pose(rotation, at));
}

TagMap random_layout() {
  RandomStream random(20260507);
  TagMap map;
  map.frame = "field";
  map.extensions = {{"x_field", "{length_m: 16.541, width_m: 8.211}"}};
  int id = 1;
  for (const Eigen::Quaterniond& rotation : awkward_rotations())
    map.tags.push_back(tag_with(id++, rotation, random));
  for (; id <= 200; ++id) {
    const Eigen::Vector4d q{random.normal(), random.normal(), random.normal(), random.normal()};
    map.tags.push_back(tag_with(id, Eigen::Quaterniond(q.normalized()), random));
  }
  return map;
}

/// Tags that lean to no side: what a heading and a pitch hold.
TagMap layout_of_headings() {
  RandomStream random(20260508);
  TagMap map;
  map.frame = "field";
  for (int id = 1; id <= 100; ++id) {
    const double yaw = random.uniform(-3.1, 3.1),
                 pitch = id % 10 == 0 ? 0.5 * std::numbers::pi : random.uniform(-1.5, 1.5);
    const double c = std::cos(pitch), s = std::sin(pitch);
    // As turned about y by the pitch, then about z by the heading.
    const Eigen::Vector3d out(std::cos(yaw) * c, std::sin(yaw) * c, -s),
        right(-std::sin(yaw), std::cos(yaw), 0);
    const PlacedTag placed{Eigen::Vector3d{random.uniform(0, 16), random.uniform(0, 8), 1.0}, right,
                           (-out).cross(right)};
    map.tags.push_back(map_tag("tag36h11", id, 0.1651, placed.T_map_tag()));
  }
  return map;
}

MapReadOptions options_for(const TagMap& map) {
  MapReadOptions options;
  options.only_where_missing = true;
  options.family = map.tags.front().key.family;
  for (const MapTag& tag : map.tags) options.sizes.set(tag.key, tag.size_m);
  return options;
}

TagMap through(const TagMap& map, MapFormat format, const MapReadOptions& options) {
  const auto path = temporary_folder() / "through";
  write_tag_map_as(path, map, format);
  const MapReading reading = read_tag_map(path, options);  // recognised, whatever it is called
  EXPECT_EQ(reading.format, format) << info_of(format).title;
  return reading.map;
}

/// Counts the tags that were compared.
int expect_same_layout(const TagMap& a, const TagMap& b, const std::string& way) {
  EXPECT_EQ(a.tags.size(), b.tags.size()) << way;
  int compared = 0;
  for (const MapTag& tag : a.tags) {
    const MapTag* other = b.find(tag.key);
    if (!other) {
      ADD_FAILURE() << way << " lost " << to_string(tag.key);
      continue;
    }
    EXPECT_THAT(other->T_map_tag, PoseNear(tag.T_map_tag, kSame_m, kSame_rad))
        << way << ", tag " << tag.key.id;
    EXPECT_NEAR(other->size_m, tag.size_m, kSame_m) << way;
    ++compared;
  }
  return compared;
}

int round_trips(const TagMap& map, const std::vector<MapFormat>& formats) {
  const MapReadOptions options = options_for(map);
  int compared = 0;
  for (const MapFormat first : formats) {
    const TagMap once = through(map, first, options);
    compared += expect_same_layout(map, once, std::string(info_of(first).name));
    for (const MapFormat second : formats)
      compared += expect_same_layout(map, through(once, second, options),
                                     fmt::format("{} to {}", info_of(first).name, info_of(second).name));
  }
  return compared;
}

TEST(MapFormats, EveryPairKeepsAnyLayout) {
  using enum MapFormat;
  const TagMap map = random_layout();
  EXPECT_EQ(round_trips(map, {kAprilTrack, kWpilibJson, kLimelight, kAprilTagRos, kAprilTagRos2, kTagSlam,
                              kArucoMarkerMap, kRtabmap}),
            200 * (8 + 64));
}

TEST(MapFormats, EveryPairKeepsHeadings) {
  using enum MapFormat;
  EXPECT_EQ(round_trips(layout_of_headings(), {kAprilTrack, kWpilibJson, kWpilibCsv, kLimelight, kAprilTagRos,
                                               kAprilTagRos2, kTagSlam, kArucoMarkerMap, kRtabmap}),
            100 * (9 + 81));
}

TEST(MapFormats, EveryPairKeepsAPrintedGrid) {
  using enum MapFormat;
  const AprilGrid grid{.rows = 3, .columns = 4, .tag_size_m = 0.0352, .tag_spacing = 0.3, .first_id = 11};
  EXPECT_EQ(round_trips(grid.map(), {kAprilTrack, kKalibrAprilGrid, kWpilibJson, kAprilTagRos, kAprilTagRos2,
                                     kTagSlam, kRtabmap}),
            12 * (7 + 49));
}

TEST(MapFormats, SizesThatDifferComeBack) {
  using enum MapFormat;
  TagMap map = random_layout();
  for (std::size_t i = 0; i < map.tags.size(); ++i)
    map.tags[i].size_m = 0.01 + 0.0137 * static_cast<double>(i);
  MapReadOptions no_options;
  for (const MapFormat format :
       {kAprilTrack, kLimelight, kAprilTagRos, kAprilTagRos2, kTagSlam, kArucoMarkerMap})
    EXPECT_EQ(expect_same_layout(map, through(map, format, no_options), std::string(info_of(format).name)),
              200);
}

TEST(MapFormats, NamesAreUniqueAndKnown) {
  using enum MapFormat;
  for (const MapFormatInfo& info : map_formats()) EXPECT_EQ(map_format_named(info.name), info.format);
  EXPECT_EQ(map_formats().size(), 10u);
  EXPECT_EQ(map_format_named("dxf"), std::nullopt);
  for (const char* name : {"o.yaml", "a.json/o.yml"}) EXPECT_EQ(map_format_of_ending(name), kAprilTrack);
  EXPECT_EQ(map_format_of_ending("o.fmap"), kLimelight);
  EXPECT_EQ(map_format_of_ending("o.ini"), kRtabmap);
  for (const char* name : {"o.json", "o.csv", "o.txt", "o", "yaml"})
    EXPECT_EQ(map_format_of_ending(name), std::nullopt) << name;
}

TEST(KalibrGrid, WritesTheFileItWasReadFrom) {
  const std::string text =
      "target_type: 'aprilgrid'\ntagCols: 6\ntagRows: 5\ntagSize: 0.088\ntagSpacing: 0.3\ncodeOffset: 7\n";
  const MapReading reading = read_layout(text);
  EXPECT_EQ(reading.format, MapFormat::kKalibrAprilGrid);
  const auto path = temporary_folder() / "target.yaml";
  write_tag_map_as(path, reading.map, MapFormat::kKalibrAprilGrid);
  EXPECT_EQ(read_file(path), text);
}

TEST(KalibrGrid, SaysWhyAMapIsNone) {
  const TagMap grid = AprilGrid{.rows = 2, .columns = 3, .tag_size_m = 0.1, .tag_spacing = 0.2}.map();
  const auto why_not = [](const TagMap& map) {
    const auto path = temporary_folder() / "target.yaml";
    const std::string message = message_of([&] { write_tag_map_as(path, map, MapFormat::kKalibrAprilGrid); });
    EXPECT_FALSE(std::filesystem::exists(path));
    return message;
  };
  TagMap map = grid;
  map.tags[4].T_map_tag =
      Pose(Eigen::Quaterniond::Identity(), map.tags[4].T_map_tag.translation() + Eigen::Vector3d(0, 0, 1e-6));
  EXPECT_NE(why_not(map).find("tag36h11b2/4 is 0.001 mm"), std::string::npos) << why_not(map);
  map = grid;
  map.tags[2].size_m = 0.11;
  EXPECT_NE(why_not(map).find("tag36h11b2/2 has another size"), std::string::npos) << why_not(map);
  map = grid;
  map.tags.pop_back();
  EXPECT_NE(why_not(map).find("full rows"), std::string::npos) << why_not(map);
  map = grid;
  for (MapTag& tag : map.tags) tag.key.family = "tag36h11";
  EXPECT_NE(why_not(map).find("tag36h11/0"), std::string::npos) << why_not(map);
  map = grid;
  map.tags.resize(1);
  EXPECT_NE(why_not(map).find("single tag"), std::string::npos) << why_not(map);
}

TEST(MapFormats, WhatIsNoneIsToldWithTheListOfKnownOnes) {
  for (const std::string text : {"Some notes: and no: layout\n", "a: 1\n", "hello\n", "<robot name=\"x\"/>",
                                 "1,2,3\n4,5,6\n", "[1, 2]", "{\"a\": 1}"}) {
    const std::string message = complaint_about_layout(text);
    for (const char* part :
         {"layout.txt", "WPILib", "Limelight", "apriltag_ros", "TagSLAM", "aruco", "RTAB-Map", "Kalibr"})
      EXPECT_NE(message.find(part), std::string::npos) << "no '" << part << "' in: " << message;
  }
}

/// In place of `what`: of NaN, infinity, ids, lengths of quaternions that are no tag's.
TEST(MapFormats, HostileNumbersAreRefusedByEachReader) {
  using enum MapFormat;
  TagMap map;
  map.frame = "field";
  // Numbers that are written in one way only, and each once.
  map.tags = {map_tag("tag36h11", 77, 0.375, Pose(Eigen::Quaterniond::Identity(), {1.625, 2.6875, 0.5625}))};
  MapReadOptions options = options_for(map);
  int refused = 0;
  for (const MapFormat format :
       {kAprilTrack, kWpilibJson, kLimelight, kAprilTagRos, kAprilTagRos2, kTagSlam, kRtabmap}) {
    const auto path = temporary_folder() / "good";
    write_tag_map_as(path, map, format);
    const std::string good = read_file(path);
    ASSERT_EQ(complaint_about_layout(good, options), "nothing was thrown") << good;
    for (const std::string bad : {"nan", "inf", "1e300", "-1e9", "\"x\""}) {
      std::string text = good;
      const auto at = text.find("2.6875");
      ASSERT_NE(at, std::string::npos) << good;
      text.replace(at, 6, bad);
      EXPECT_NE(complaint_about_layout(text, options), "nothing was thrown")
          << info_of(format).name << ": " << bad;
      ++refused;
    }
    for (const std::string bad : {"587", "-1", "7.5", "99999999999999"}) {
      std::string text = good;
      for (auto at = text.find("77"); at != std::string::npos; at = text.find("77", at + bad.size()))
        text.replace(at, 2, bad);
      EXPECT_NE(complaint_about_layout(text, options), "nothing was thrown")
          << info_of(format).name << ": " << bad;
      ++refused;
    }
  }
  EXPECT_EQ(refused, 7 * 9);
}

TEST(MapFormats, ATruncatedFileIsNeverReadAsAShorterMap) {
  using enum MapFormat;
  TagMap map = random_layout();
  map.tags.resize(3);
  const MapReadOptions options = options_for(map);
  int cuts = 0;
  for (const MapFormat format : {kWpilibJson, kLimelight, kAprilTagRos}) {
    const auto path = temporary_folder() / "whole";
    write_tag_map_as(path, map, format);
    const std::string whole = read_file(path);
    for (std::size_t size = 0; size + 2 < whole.size(); size += 7, ++cuts)
      EXPECT_NE(complaint_about_layout(whole.substr(0, size), options), "nothing was thrown")
          << whole.substr(0, size);
  }
  EXPECT_GT(cuts, 100);
}

TEST(MapFormats, AFileOfAGigabyteIsNoLayout) {
  const auto path = layout_file("apriltrack_map: 1\n");
  std::filesystem::resize_file(path, 1u << 30);  // a hole: nothing is written
  const std::string message = message_of([&] { read_tag_map(path); });
  EXPECT_NE(message.find("too large"), std::string::npos) << message;
}

TEST(MapFormats, StatedSizesAndFamiliesMustAgreeWithGivenOnes) {
  TagMap map;
  map.tags = {map_tag("tag25h9", 4, 0.16, Pose())};
  for (const MapFormat format : {MapFormat::kAprilTrack, MapFormat::kLimelight, MapFormat::kAprilTagRos2}) {
    const auto path = temporary_folder() / "map";
    write_tag_map_as(path, map, format);
    EXPECT_NO_THROW(read_tag_map(path, with_size(0.16)));
    std::string message = message_of([&] { read_tag_map(path, with_size(0.2)); });
    EXPECT_NE(message.find("tag25h9/4 is 0.16 m here, and 0.2 m"), std::string::npos) << message;
    MapReadOptions options;
    options.family = "tag36h11";
    message = message_of([&] { read_tag_map(path, options); });
    EXPECT_NE(message.find("--family"), std::string::npos) << message;
    options = with_size(0.2);
    options.family = "tag36h11";
    options.only_where_missing = true;
    EXPECT_EQ(read_tag_map(path, options).map.tags[0].size_m, 0.16);
  }
}

TEST(MapFormats, AsAFormatThatItIsNotIsRefused) {
  const auto path = layout_file("ID,X,Y,Z,Rotation\n1,0,0,0,0\n");
  EXPECT_EQ(read_tag_map_as(path, MapFormat::kWpilibCsv, with_size(0.1)).map.tags.size(), 1u);
  EXPECT_NE(message_of([&] { read_tag_map_as(path, MapFormat::kTagSlam, with_size(0.1)); }).find("TagSLAM"),
            std::string::npos);
}

TEST(MapFormats, AFailedWriteLeavesTheOldFile) {
  const auto path = layout_file("old", "out.csv");
  TagMap map;
  map.tags = {map_tag("tag36h11", 7, 0.1, rolled_tag().T_map_tag())};
  EXPECT_THROW(write_tag_map_as(path, map, MapFormat::kWpilibCsv), Error);
  EXPECT_EQ(read_file(path), "old");
  EXPECT_EQ(
      message_of(
          [&] { write_tag_map_as(temporary_folder() / "no" / "out.json", map, MapFormat::kWpilibJson); },
          ErrorKind::kIo)
          .find("nothing"),
      std::string::npos);
}

}  // namespace
}  // namespace apriltrack::test
