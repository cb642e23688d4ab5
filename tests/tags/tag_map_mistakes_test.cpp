#include <gmock/gmock.h>

#include "apriltrack/io/atomic_file.h"
#include "support/error_message.h"
#include "tag_map_support.h"

namespace apriltrack::test {
namespace {

std::string with_covariance(const Matrix6d& covariance) {
  std::string text = "    covariance: [";
  for (int i = 0; i < 36; ++i) text += (i ? ", " : "") + std::to_string(covariance(i / 6, i % 6));
  return one_tag("7", "0.16", kPose + text + "]\n");
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
      {with_position("{x: 0, y: 1e30, z: 0}"),
       {"lab.yaml:8: tags[0].pose.position.y: of tag tag36h11/7: must lie in [-1e+07, 1e+07] metres (is "
        "1e+30)"}},
      {with_position("{x: -1.0001e7, y: 0, z: 0}"),
       {"lab.yaml:8: tags[0].pose.position.x", "is -1.0001e+07"}},
      {with_position("{x: 0, y: 0, z: .nan}"), {"lab.yaml:8: tags[0].pose.position.z", "finite"}},
      {with_position("{x: -.inf, y: 0, z: 0}"), {"lab.yaml:8: tags[0].pose.position.x", "finite"}},
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
  EXPECT_EQ(complaint_about(with_position("{x: 500000, y: 1e7, z: -1e7}")), "no complaint") << "UTM";
  EXPECT_EQ(complaint_about(with_covariance(Matrix6d::Zero())), "no complaint");
  EXPECT_EQ(complaint_about(with_covariance(Matrix6d::Ones())), "no complaint") << "rank one is semidefinite";
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
  const auto read = [] { read_tag_map(temporary_folder() / "missing.yaml"); };
  EXPECT_THAT(message_of(read, ErrorKind::kIo), ::testing::HasSubstr("missing.yaml"));
  TagMap map = map_from(one_tag("7", "0.16"));
  EXPECT_THROW(write_tag_map("/proc/no-such-folder/map.yaml", map), Error);
}

}  // namespace
}  // namespace apriltrack::test
