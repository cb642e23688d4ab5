#include "apriltrack/tags/tag_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>
#include <tuple>

#include "apriltrack/base/error.h"
#include "apriltrack/base/random.h"
#include "apriltrack/io/atomic_file.h"
#include "support/pose_matchers.h"
#include "support/shared_data.h"

namespace apriltrack {
namespace {

/// Without the wait for the disk of an atomic write: the tests below write thousands of files.
std::filesystem::path file_with(const std::string& text) {
  const auto path = test::temporary_folder() / "lab.yaml";
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

TagMap map_from(const std::string& text) {
  return read_tag_map(file_with(text));
}

std::string complaint_about(const std::string& text) {
  const auto path = file_with(text);
  try {
    read_tag_map(path);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kInvalidInput) << error.what();
    return error.what();
  }
  return "no complaint";
}

/// Lines 1 to 3 of a map file; tags begin on line 5.
const std::string kHead = "apriltrack_map: 1\nframe: world\ndefault_family: tag36h11\ntags:\n";
const std::string kPose =
    "    pose:\n      position: {x: 1.5, y: -2, z: 0.25}\n      orientation: {x: 0.5, y: 0.5, z: -0.5, w: "
    "0.5}\n";

std::string one_tag(const std::string& id, const std::string& size, const std::string& rest = kPose) {
  return kHead + "  - id: " + id + "\n    size: " + size + "\n" + rest;
}

std::string with_orientation(const std::string& orientation) {
  return one_tag("7", "0.16",
                 "    pose:\n      position: {x: 0, y: 0, z: 0}\n      orientation: " + orientation + "\n");
}

std::string with_covariance(const Matrix6d& covariance) {
  std::string text = "    covariance: [";
  for (int i = 0; i < 36; ++i) text += (i ? ", " : "") + std::to_string(covariance(i / 6, i % 6));
  return one_tag("7", "0.16", kPose + text + "]\n");
}

void expect_same(const TagMap& a, const TagMap& b) {
  EXPECT_EQ(a.frame, b.frame);
  EXPECT_EQ(a.default_family, b.default_family);
  EXPECT_EQ(a.provenance, b.provenance);
  EXPECT_EQ(a.extensions, b.extensions);
  ASSERT_EQ(a.tags.size(), b.tags.size());
  for (std::size_t i = 0; i < a.tags.size(); ++i) {
    const MapTag& p = a.tags[i];
    const MapTag& q = b.tags[i];
    EXPECT_EQ(p.key, q.key);
    EXPECT_EQ(p.size_m, q.size_m);
    // To the last bit, the sign of zero included.
    for (int k = 0; k < 3; ++k) {
      const double x = p.T_map_tag.translation()[k];
      EXPECT_EQ(x, q.T_map_tag.translation()[k]);
      EXPECT_EQ(std::signbit(x), std::signbit(q.T_map_tag.translation()[k]));
    }
    EXPECT_EQ(p.T_map_tag.rotation().coeffs(), q.T_map_tag.rotation().coeffs()) << to_string(p.key);
    EXPECT_EQ(p.covariance, q.covariance);
    ASSERT_EQ(p.statistics.has_value(), q.statistics.has_value());
    if (p.statistics) {
      EXPECT_EQ(p.statistics->views, q.statistics->views);
      EXPECT_EQ(p.statistics->residual_rms_px, q.statistics->residual_rms_px);
      EXPECT_EQ(p.statistics->flags, q.statistics->flags);
    }
    EXPECT_EQ(p.extensions, q.extensions);
  }
}

Matrix6d random_covariance(RandomStream& random) {
  Matrix6d root;
  for (int i = 0; i < 36; ++i) root(i / 6, i % 6) = random.normal();
  const Vector6d scale = (Vector6d() << 1e-3, 2e-3, 1e-2, 1e-2, 3e-2, 1e-4).finished();
  return scale.asDiagonal() * (root * root.transpose()) * scale.asDiagonal();
}

MapTag random_tag(RandomStream& random, int id) {
  MapTag tag;
  tag.key = {id % 3 == 0 ? "tagStandard41h12" : "tag36h11", id};
  tag.size_m = random.uniform(1e-3, 2.0);
  const Eigen::Vector4d q(random.normal(), random.normal(), random.normal(), random.normal());
  const double magnitude = std::pow(10.0, random.uniform(-12.0, 6.0));
  tag.T_map_tag = Pose(
      Eigen::Quaterniond(q),
      magnitude * Eigen::Vector3d(random.normal(), random.normal(), id % 7 == 0 ? -0.0 : random.normal()));
  if (id % 2 == 0) tag.covariance = random_covariance(random);
  if (id % 5 == 0) tag.covariance = Matrix6d::Zero();
  if (id % 4 == 1) tag.statistics = TagStatistics{id, random.uniform(), {"weak", "seen once: \"yes\""}};
  return tag;
}

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

TEST(TagMapYaml, NamesLineAndKeyOfEveryMistake) {
  Matrix6d asymmetric = Matrix6d::Identity();
  asymmetric(0, 1) = 0.5;
  Matrix6d indefinite = Matrix6d::Identity();
  indefinite(0, 1) = indefinite(1, 0) = 1.1;
  Matrix6d negative = Matrix6d::Identity();
  negative(4, 4) = -1.0;
  Matrix6d no_variance = Matrix6d::Identity();
  no_variance(2, 2) = 0.0;
  no_variance(1, 2) = no_variance(2, 1) = 0.5;
  const std::vector<std::pair<std::string, std::vector<std::string>>> cases = {
      {"", {"lab.yaml"}},
      {"[1, 2]", {"lab.yaml:1"}},
      {"frame: world\ntags: []\n", {"lab.yaml:1", "'apriltrack_map' is missing"}},
      {"apriltrack_map: 2\nframe: world\n", {"lab.yaml:1: apriltrack_map", "version 1", "2"}},
      {"apriltrack_map: one\n", {"lab.yaml:1: apriltrack_map"}},
      {"apriltrack_map: 1\ntags: []\n", {"'frame' is missing"}},
      {"apriltrack_map: 1\nframe: world\n", {"'tags' is missing"}},
      {"apriltrack_map: 1\nframe: world\ntags: []\n", {"lab.yaml:3: tags", "at least one tag"}},
      {"apriltrack_map: 1\nframe: world\ntags: {0: 1}\n", {"lab.yaml:3: tags", "list"}},
      {"apriltrack_map: 1\nframe: world\ndefault_family: tag36h12\ntags: []\n",
       {"lab.yaml:3: default_family", "tag36h12", "tag36h11"}},
      {"apriltrack_map: 1\nframe: world\ndefualt_family: tag36h11\n",
       {"lab.yaml:3: defualt_family: unknown key"}},
      {"apriltrack_map: 1\nframe: world\nframe: body\n", {"lab.yaml:3", "frame"}},
      {"apriltrack_map: 1\nframe: world\nprovenance: {a: [1]}\n", {"lab.yaml:3: provenance.a"}},
      {"apriltrack_map: 1\nframe: world\ntags:\n  - id: 0\n    size: 0.1\n" + kPose,
       {"lab.yaml:4", "default_family"}},
      {one_tag("587", "0.16"), {"lab.yaml:5: tags[0].id", "0 to 586", "587"}},
      {one_tag("-1", "0.16"), {"lab.yaml:5: tags[0].id", "-1"}},
      {one_tag("010", "0.16"), {"lab.yaml:5: tags[0].id", "010"}},
      {one_tag("1.5", "0.16"), {"lab.yaml:5: tags[0].id"}},
      {one_tag("7", "-0.16"), {"lab.yaml:6: tags[0].size", "> 0", "-0.16"}},
      {one_tag("7", "0"), {"lab.yaml:6: tags[0].size", "> 0"}},
      {one_tag("7", ".nan"), {"lab.yaml:6: tags[0].size", "finite"}},
      {one_tag("7", ".inf"), {"lab.yaml:6: tags[0].size", "finite"}},
      {one_tag("7", "16 cm"), {"lab.yaml:6: tags[0].size", "16 cm"}},
      {one_tag("7", "0.16", ""), {"lab.yaml:5: tags[0]", "'pose' is missing"}},
      {kHead + "  - size: 0.16\n" + kPose, {"lab.yaml:5: tags[0]", "'id' is missing"}},
      {kHead + "  - id: 7\n" + kPose, {"lab.yaml:5: tags[0]", "'size' is missing"}},
      {one_tag("7", "0.16", kPose + "    family: tag36h1\n"),
       {"lab.yaml:10: tags[0].family", "tag36h1", "tag25h9"}},
      {one_tag("35", "0.16", kPose + "    family: tag25h9\n"),
       {"lab.yaml:5: tags[0].id", "tag25h9", "0 to 34"}},
      {one_tag("7", "0.16", kPose + "    colour: red\n"), {"lab.yaml:10: tags[0].colour: unknown key"}},
      {one_tag("7", "0.16", kPose + "  - id: 7\n    size: 0.1\n" + kPose),
       {"lab.yaml:10: tags[1]", "tag36h11/7", "lab.yaml:5"}},
      {one_tag("7", "0.16", kPose + "  - id: 7\n    family: tag36h11\n    size: 0.1\n" + kPose),
       {"lab.yaml:10: tags[1]", "tag36h11/7", "lab.yaml:5"}},
      {with_orientation("{x: 0, y: 0, z: 0, w: 0}"), {"lab.yaml:9: tags[0].pose.orientation", "length 0"}},
      {with_orientation("{x: 0, y: 0, z: 0, w: 1.002}"), {"lab.yaml:9: tags[0].pose.orientation", "1.002"}},
      {with_orientation("{x: 1e200, y: 1e200, z: 0, w: 0}"), {"lab.yaml:9: tags[0].pose.orientation"}},
      {with_orientation("{x: 0, y: 0, z: 0, w: .nan}"), {"lab.yaml:9: tags[0].pose.orientation.w", "finite"}},
      {with_orientation("{x: 0, y: 0, z: 0}"), {"lab.yaml:9: tags[0].pose.orientation", "'w' is missing"}},
      {with_orientation("[0, 0, 0, 1]"), {"lab.yaml:9: tags[0].pose.orientation"}},
      {with_orientation("{x: 0, y: 0, z: 0, w: 1, x_mine: 2}"), {"lab.yaml:9", "x_mine", "top level"}},
      {one_tag("7", "0.16", kPose + "    covariance: [1, 2, 3]\n"),
       {"lab.yaml:10: tags[0].covariance", "36"}},
      {with_covariance(asymmetric), {"lab.yaml:10: tags[0].covariance", "symmetric"}},
      {with_covariance(indefinite), {"lab.yaml:10: tags[0].covariance", "positive semidefinite"}},
      {with_covariance(no_variance), {"lab.yaml:10: tags[0].covariance", "positive semidefinite"}},
      {with_covariance(negative), {"lab.yaml:10: tags[0].covariance", "variance 4", ">= 0"}},
      {one_tag("7", "0.16", kPose + "    statistics: {views: -1, residual_rms_px: 0}\n"),
       {"lab.yaml:10", "views"}},
      {one_tag("7", "0.16", kPose + "    statistics: {views: 1, residual_rms_px: -1}\n"),
       {"lab.yaml:10", "residual_rms_px"}},
      {one_tag("7", "0.16", kPose + "    statistics: {views: 1, rms: 1}\n"),
       {"lab.yaml:10", "rms", "unknown key"}},
  };
  for (const auto& [text, fragments] : cases) {
    const std::string message = complaint_about(text);
    for (const std::string& fragment : fragments) {
      EXPECT_NE(message.find(fragment), std::string::npos)
          << "no '" << fragment << "' in: " << message << "\nfor\n"
          << text;
    }
  }
  EXPECT_EQ(complaint_about(one_tag("586", "0.16")), "no complaint");
  EXPECT_EQ(complaint_about(with_covariance(Matrix6d::Zero())), "no complaint");
  EXPECT_EQ(complaint_about(with_covariance(Matrix6d::Ones())), "no complaint") << "rank one is semidefinite";
}

TEST(TagMapYaml, SameIdOfAnotherFamilyIsAnotherTag) {
  const TagMap map =
      map_from(one_tag("7", "0.16", kPose + "  - id: 7\n    family: tag25h9\n    size: 0.1\n" + kPose));
  EXPECT_EQ(map.find({"tag36h11", 7})->size_m, 0.16);
  EXPECT_EQ(map.find({"tag25h9", 7})->size_m, 0.1);
  EXPECT_EQ(map.find({"tag16h5", 7}), nullptr);
}

TEST(TagMapYaml, SurvivesFilesCutAnywhere) {
  RandomStream random(7);
  TagMap map;
  map.provenance = {{"tool", "a \"quoted\" text"}};
  map.extensions = {{"x_site", "{a: [1, 2]}"}};
  for (int id = 0; id < 3; ++id) map.tags.push_back(random_tag(random, id));
  const auto path = test::temporary_folder() / "whole.yaml";
  write_tag_map(path, map);
  const std::string whole = read_file(path);
  const auto part = path.parent_path() / "part.yaml";
  int refused = 0;
  int readable = 0;
  // Every third byte, but not within the comment on top.
  const std::size_t begin = whole.find("apriltrack_map");
  for (std::size_t length = begin; length < whole.size(); length += 3) {
    std::ofstream(part, std::ios::binary) << whole.substr(0, length);
    try {
      EXPECT_GE(read_tag_map(part).tags.size(), 1u);
      ++readable;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kInvalidInput);
      ++refused;
    }
  }
  EXPECT_GT(refused, static_cast<int>(whole.size() - begin) / 6);
  EXPECT_GT(readable, 0) << "cuts between two tags leave a whole map";
}

TEST(TagMapYaml, SurvivesDamagedBytes) {
  const std::string whole = one_tag("7", "0.16");
  RandomStream random(8);
  int refused = 0;
  for (int trial = 0; trial < 500; ++trial) {
    std::string text = whole;
    for (int i = 0; i < 3; ++i) {
      text[static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(text.size())))] =
          static_cast<char>(random() & 0xFF);
    }
    refused += complaint_about(text) != "no complaint";
  }
  EXPECT_GT(refused, 300);
}

TEST(TagMapYaml, TellsUnreadableFilesFromWrongOnes) {
  try {
    read_tag_map(test::temporary_folder() / "missing.yaml");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kIo);
    EXPECT_NE(std::string(error.what()).find("missing.yaml"), std::string::npos);
  }
  TagMap map = map_from(one_tag("7", "0.16"));
  EXPECT_THROW(write_tag_map("/proc/no-such-folder/map.yaml", map), Error);
}

std::string text_of(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

/// Every way to spoil a map in memory, and what its message must say.
std::vector<std::tuple<TagMap, std::string, std::string>> bad_maps(const TagMap& good) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  std::vector<std::tuple<TagMap, std::string, std::string>> bad;
  const auto spoil = [&](const std::string& member, const std::string& value, const auto& change) {
    TagMap map = good;
    change(map, map.tags[0]);
    bad.emplace_back(map, member, value);
  };
  spoil("no tags", "", [](TagMap& map, MapTag&) { map.tags.clear(); });
  spoil("twice", "", [](TagMap& map, MapTag& tag) { map.tags.push_back(tag); });
  spoil("default_family", "'tag99h1'", [](TagMap& map, MapTag&) { map.default_family = "tag99h1"; });
  spoil("family", "'tag99h1'", [](TagMap&, MapTag& tag) { tag.key.family = "tag99h1"; });
  spoil("id", "587", [](TagMap&, MapTag& tag) { tag.key.id = 587; });
  spoil("id", "-1", [](TagMap&, MapTag& tag) { tag.key.id = -1; });
  for (const double size_m : {nan, infinite, 0.0, -0.16, 160.0})
    spoil("size_m", text_of(size_m), [&](TagMap&, MapTag& tag) { tag.size_m = size_m; });
  for (const double x : {nan, infinite}) {
    spoil("T_map_tag", text_of(x), [&](TagMap&, MapTag& tag) {
      tag.T_map_tag = Pose(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0, x, 0));
    });
  }
  spoil("T_map_tag", "nan", [&](TagMap&, MapTag& tag) {
    tag.T_map_tag = Pose(Eigen::Quaterniond(nan, 0, 0, 1), Eigen::Vector3d::Zero());
  });
  spoil("T_map_tag", "0 0 0 0", [&](TagMap&, MapTag& tag) {
    tag.T_map_tag = Pose(Eigen::Quaterniond(0, 0, 0, 0), Eigen::Vector3d::Zero());
  });
  const auto with = [](int row, int column, double value, double mirrored) {
    Matrix6d covariance = Matrix6d::Identity();
    covariance(row, column) = value;
    covariance(column, row) = mirrored;
    return covariance;
  };
  const std::vector<std::pair<Matrix6d, std::string>> covariances = {
      {with(2, 5, nan, nan), "row 2, column 5 is nan"},
      {with(1, 1, infinite, infinite), "inf"},
      {with(0, 1, 0.5, 0.0), "symmetric"},
      {with(0, 1, 1.1, 1.1), "semidefinite"},
      {with(4, 4, -1.0, -1.0), "variance 4"},
      {1e-9 * with(3, 4, -1.1, -1.1), "semidefinite"}};
  for (const auto& [covariance, value] : covariances)
    spoil("covariance", value, [&](TagMap&, MapTag& tag) { tag.covariance = covariance; });
  spoil("statistics", "-1", [](TagMap&, MapTag& tag) { tag.statistics = TagStatistics{-1, 0.1, {}}; });
  spoil("statistics", "nan", [&](TagMap&, MapTag& tag) { tag.statistics = TagStatistics{1, nan, {}}; });
  return bad;
}

TEST(TagMap, ACheckNamesTagMemberAndValue) {
  const TagMap good = map_from(one_tag("7", "0.16"));
  EXPECT_NO_THROW(check_tag_map(good));
  int checked = 0;
  for (const auto& [map, member, value] : bad_maps(good)) {
    try {
      check_tag_map(map, "this map");
      ADD_FAILURE() << "not refused: " << member << " " << value;
    } catch (const Error& error) {
      const std::string message = error.what();
      EXPECT_EQ(error.kind(), ErrorKind::kInvalidInput);
      EXPECT_EQ(message.find("this map: "), 0u) << message;
      EXPECT_NE(message.find(member), std::string::npos) << message;
      EXPECT_NE(message.find(value), std::string::npos) << message;
      const bool is_of_a_tag = !map.tags.empty() && member != "default_family";
      const std::string name = is_of_a_tag ? to_string(map.tags[0].key) : "";
      EXPECT_NE(message.find(name), std::string::npos) << message;
    }
    ++checked;
  }
  EXPECT_EQ(checked, 23);
}

TEST(TagMap, ACheckPassesWhatRoundingLeaves) {
  RandomStream random(9);
  TagMap map;
  for (int id = 0; id < 100; ++id) map.tags.push_back(random_tag(random, id));
  for (MapTag& tag : map.tags)
    if (tag.covariance) tag.covariance = tag.covariance->cast<float>().cast<double>();
  map.tags[1].covariance = Matrix6d::Ones();
  EXPECT_NO_THROW(check_tag_map(map));
}

TEST(TagMapYaml, RefusesToWriteWhatCouldNotBeRead) {
  const TagMap good = map_from(one_tag("7", "0.16"));
  const auto path = test::temporary_folder() / "map.yaml";
  write_tag_map(path, good);
  const std::string before = read_file(path);
  for (const auto& [map, member, value] : bad_maps(good)) {
    try {
      write_tag_map(path, map);
      ADD_FAILURE() << "written: " << member << " " << value;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kInvalidInput);
      EXPECT_NE(std::string(error.what()).find("map.yaml"), std::string::npos) << error.what();
    }
  }
  EXPECT_EQ(read_file(path), before);
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
}  // namespace apriltrack
