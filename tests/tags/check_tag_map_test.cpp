#include <limits>
#include <sstream>
#include <tuple>

#include "apriltrack/io/atomic_file.h"
#include "tag_map_support.h"

namespace apriltrack::test {
namespace {

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
  for (const double x : {1e30, -1.0001e7}) {
    spoil("T_map_tag: position", "[-1e+07, 1e+07]", [&](TagMap&, MapTag& tag) {
      tag.T_map_tag = Pose(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0, 0, x));
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
    spoil("covariance", value,
          [covariance = covariance](TagMap&, MapTag& tag) { tag.covariance = covariance; });
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
  EXPECT_EQ(checked, 25);
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

}  // namespace
}  // namespace apriltrack::test
