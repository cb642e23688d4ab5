#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "apriltrack/export/export_map.h"
#include "hand_made_layout.h"

namespace apriltrack::test {

inline constexpr double kSize_m = 0.16;

inline std::map<std::string, PlacedTag> placed_tags() {
  return {{"tag36h11_7", rolled_tag()}, {"tag36h11_2", floor_tag()}, {"tagStandard41h12_3", leaning_tag()}};
}

inline TagMap placed_map() {
  TagMap map;
  map.frame = "lab \"2\" <a&b>";
  map.tags = {map_tag("tag36h11", 7, kSize_m, rolled_tag().T_map_tag()),
              map_tag("tag36h11", 2, kSize_m, floor_tag().T_map_tag()),
              map_tag("tagStandard41h12", 3, kSize_m, leaning_tag().T_map_tag())};
  return map;
}

inline std::filesystem::path written(const TagMap& map, ExportFormat format, const std::string& name) {
  const auto path = temporary_folder() / name;
  write_exported_map(path, map, format);
  return path;
}

}  // namespace apriltrack::test
