// Kalibr's target file holds a printed grid by its numbers: no tag can be anywhere else.
#include "kalibr_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "../aprilgrid_reader.h"
#include "apriltrack/base/error.h"
#include "apriltrack/io/numbers.h"
#include "foreign_map.h"
#include "map_words.h"

namespace apriltrack {
namespace {

constexpr double kSame_m = 1e-9, kSame_rad = 1e-9;

[[noreturn]] void fail_no_grid(const std::string& file, const std::string& why) {
  throw invalid_input(file,
                      "Kalibr's target file holds nothing but its printed grid, and the map is none: " + why);
}

/// The grid whose first tags these are; checked by the caller, tag by tag. Tags in the order of their ids.
AprilGrid guess_grid(const std::vector<MapTag>& tags, const std::string& file) {
  AprilGrid grid;
  grid.first_id = tags.front().key.id;
  grid.tag_size_m = tags.front().size_m;
  if (tags.size() < 2) fail_no_grid(file, "a single tag does not tell the width of the lanes");
  const double first_y = tags.front().T_map_tag.translation().y();
  const auto leaves_row = [&](const MapTag& tag) {
    return std::abs(tag.T_map_tag.translation().y() - first_y) > 0.5 * grid.tag_size_m;
  };
  grid.columns = static_cast<int>(std::ranges::find_if(tags, leaves_row) - tags.begin());
  grid.rows = static_cast<int>(tags.size()) / grid.columns;
  const double pitch_m = (tags[1].T_map_tag.translation() - tags[0].T_map_tag.translation()).norm();
  // (1 + spacing) size = pitch; rounded to what a file would say, where that is the same board.
  const double spacing = pitch_m / grid.tag_size_m - 1.0;
  const double rounded = std::round(spacing * 1e9) / 1e9;
  grid.tag_spacing = std::abs(rounded - spacing) < 1e-12 ? rounded : spacing;
  return grid;
}

void check_is_grid(const std::vector<MapTag>& tags, const AprilGrid& grid, const std::string& file) {
  const TagMap expected = grid.map();
  if (tags.size() != expected.tags.size())
    fail_no_grid(file, fmt::format("{} tags make no full rows of {}", tags.size(), grid.columns));
  for (std::size_t i = 0; i < tags.size(); ++i) {
    const MapTag& tag = tags[i];
    const MapTag& place = expected.tags[i];
    const std::string name = to_string(tag.key);
    if (tag.key != place.key)
      fail_no_grid(file, fmt::format("{} is where {} should be", name, to_string(place.key)));
    if (std::abs(tag.size_m - place.size_m) > kSame_m)
      fail_no_grid(file, fmt::format("{} has another size", name));
    const Pose difference = place.T_map_tag.inverse() * tag.T_map_tag;
    const double aside_m = difference.translation().norm();
    const double turn_rad = rotation_angle_rad(place.T_map_tag.rotation(), tag.T_map_tag.rotation());
    if (aside_m > kSame_m || turn_rad > kSame_rad)
      fail_no_grid(
          file,
          fmt::format("{} is {:.3g} mm and {:.3g} rad off its place on a board of {} x {} (the origin is "
                      "the bottom left corner of the first tag, x right, y down)",
                      name, 1e3 * aside_m, turn_rad, grid.rows, grid.columns));
  }
}

}  // namespace

bool is_kalibr_grid(const MapText& text) {
  return text.root && text.root->is_map() && text.root->find("target_type");
}

MapReading read_kalibr_grid(const MapText& text, const MapReadOptions& options) {
  MapReading reading{aprilgrid_of(*text.root).map(), MapFormat::kKalibrAprilGrid, {}};
  check_agreement(reading.map, options, text.file);
  return reading;
}

std::string write_kalibr_grid(const TagMap& map, const MapWriteOptions&, const std::string& file,
                              std::vector<ConversionLoss>& losses) {
  std::vector<MapTag> tags = map.tags;
  std::ranges::sort(tags, {}, [](const MapTag& tag) { return tag.key.id; });
  for (const MapTag& tag : tags) {
    if (tag.key.family != "tag36h11b2")
      fail_no_grid(
          file, fmt::format("{} is not of tag36h11b2, the family of its printed tags", to_string(tag.key)));
  }
  const AprilGrid grid = guess_grid(tags, file);
  if (grid.tag_spacing <= 0.0 || grid.tag_spacing > 1.0)
    fail_no_grid(file, fmt::format("lanes {:.3g} times as wide as a tag are not printed", grid.tag_spacing));
  check_is_grid(tags, grid, file);
  add_left_out(map, {.sizes = true, .families = true, .frame_name = map.frame == "board"}, losses);
  std::string out =
      fmt::format("target_type: 'aprilgrid'\ntagCols: {}\ntagRows: {}\ntagSize: {}\ntagSpacing: {}\n",
                  grid.columns, grid.rows, yaml_double(grid.tag_size_m), yaml_double(grid.tag_spacing));
  if (grid.first_id != 0) out += fmt::format("codeOffset: {}\n", grid.first_id);
  return out;
}

}  // namespace apriltrack
