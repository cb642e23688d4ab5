#include "apriltrack/tags/aprilgrid.h"

#include <fmt/format.h>

#include <cmath>

#include "aprilgrid_reader.h"
#include "apriltrack/base/error.h"

namespace apriltrack {
namespace {

constexpr const char* kFamily = "tag36h11b2";

/// nullptr when the field is good, else the range that it breaks.
const char* broken_range_of_count(int count) {
  return count >= 1 && count <= 1000 ? nullptr : "must lie in [1, 1000]";
}
const char* broken_range_of_size(double size_m) {
  return std::isfinite(size_m) && size_m > 0.0 ? nullptr : "must be a finite number of metres > 0";
}
const char* broken_range_of_spacing(double spacing) {
  return spacing > 0.0 && spacing <= 1.0 ? nullptr : "must lie in (0, 1]: it is a fraction of the tag's size";
}

/// Where a coordinate falls in the sequence tag, lane, tag, lane, ...
struct LanePosition {
  int index;        ///< Of the tag, or of the tag before the lane.
  double offset_m;  ///< From the tag's edge.
  bool is_in_tag;
};

LanePosition locate(double coordinate_m, const AprilGrid& grid) {
  const double index = std::floor(coordinate_m / grid.pitch_m());
  const double offset_m = coordinate_m - index * grid.pitch_m();
  return {static_cast<int>(index), offset_m, offset_m < grid.tag_size_m};
}

}  // namespace

void AprilGrid::check() const {
  const auto require = [](const char* broken_range, const char* field, double value) {
    if (broken_range) throw invalid_input("", fmt::format("{} {} (is {})", field, broken_range, value));
  };
  require(broken_range_of_count(rows), "rows", rows);
  require(broken_range_of_count(columns), "columns", columns);
  require(broken_range_of_size(tag_size_m), "tag_size_m", tag_size_m);
  require(broken_range_of_spacing(tag_spacing), "tag_spacing", tag_spacing);
  const int num_codes = TagFamily::get(kFamily).num_codes();
  if (first_id < 0 || first_id > num_codes - rows * columns) {
    throw invalid_input("", fmt::format("{} x {} tags from id {} on need more ids than 0 to {} of {}", rows,
                                        columns, first_id, num_codes - 1, kFamily));
  }
}

Eigen::AlignedBox2d AprilGrid::printed_area_m() const {
  const double lane_m = tag_spacing * tag_size_m;
  return {Eigen::Vector2d(-lane_m, -rows * pitch_m()), Eigen::Vector2d(columns * pitch_m(), lane_m)};
}

TagMap AprilGrid::map() const {
  check();
  TagMap map;
  map.frame = "board";
  map.default_family = kFamily;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const Eigen::Vector3d centre(column * pitch_m() + 0.5 * tag_size_m,
                                   -(row * pitch_m() + 0.5 * tag_size_m), 0.0);
      MapTag tag;
      tag.key = {kFamily, first_id + row * columns + column};
      tag.size_m = tag_size_m;
      tag.T_map_tag = Pose(Eigen::Quaterniond::Identity(), centre);
      map.tags.push_back(std::move(tag));
    }
  }
  return map;
}

AprilGrid aprilgrid_of(const YamlNode& root) {
  root.expect_keys({"target_type", "tagRows", "tagCols", "tagSize", "tagSpacing", "codeOffset"});
  const YamlNode type = root.at("target_type");
  if (type.as_string() != "aprilgrid") {
    type.fail(fmt::format("only 'aprilgrid' targets hold tags (is '{}')", type.as_string()));
  }
  const auto require = [&](std::string_view key, const char* broken_range) {
    if (broken_range) root.at(key).fail(fmt::format("{} (is {})", broken_range, root.at(key).as_string()));
  };
  AprilGrid grid;
  grid.rows = root.at("tagRows").as_int();
  grid.columns = root.at("tagCols").as_int();
  grid.tag_size_m = root.at("tagSize").as_double();
  grid.tag_spacing = root.at("tagSpacing").as_double();
  require("tagRows", broken_range_of_count(grid.rows));
  require("tagCols", broken_range_of_count(grid.columns));
  require("tagSize", broken_range_of_size(grid.tag_size_m));
  require("tagSpacing", broken_range_of_spacing(grid.tag_spacing));
  if (const auto offset = root.find("codeOffset")) grid.first_id = offset->as_int();
  const int num_codes = TagFamily::get(kFamily).num_codes();
  if (grid.first_id < 0 || grid.first_id > num_codes - grid.rows * grid.columns) {
    root.find("codeOffset")
        .value_or(root.at("tagRows"))
        .fail(fmt::format("{} x {} tags from id {} on need more ids than 0 to {} of {}", grid.rows,
                          grid.columns, grid.first_id, num_codes - 1, kFamily));
  }
  return grid;
}

AprilGrid read_aprilgrid(const std::filesystem::path& path) {
  return aprilgrid_of(YamlNode::read_file(path));
}

AprilGridPicture::AprilGridPicture(const AprilGrid& grid) : grid_(grid) {
  grid_.check();
  const TagFamily& family = TagFamily::get(kFamily);
  for (int i = 0; i < grid_.rows * grid_.columns; ++i)
    patterns_.push_back(family.pattern(grid_.first_id + i));
}

double AprilGridPicture::brightness(double x_m, double y_m) const {
  constexpr double kBlack = 0.0;
  constexpr double kWhite = 1.0;
  if (!grid_.printed_area_m().contains(Eigen::Vector2d(x_m, y_m))) return kWhite;
  const LanePosition across = locate(x_m, grid_);
  const LanePosition up = locate(-y_m, grid_);
  if (!across.is_in_tag && !up.is_in_tag) return kBlack;
  if (!across.is_in_tag || !up.is_in_tag || across.index >= grid_.columns || up.index >= grid_.rows)
    return kWhite;
  const double u = 2.0 * across.offset_m / grid_.tag_size_m - 1.0;
  const double v = 1.0 - 2.0 * up.offset_m / grid_.tag_size_m;
  return patterns_[static_cast<std::size_t>(up.index * grid_.columns + across.index)].brightness(u, v);
}

}  // namespace apriltrack
