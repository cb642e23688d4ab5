#pragma once

#include <filesystem>
#include <string>

#include "apriltrack/tags/tag_map.h"

namespace apriltrack::app {

/// The page of `map show --report`, one file that needs no network: the map in space, from above and from two
/// sides, and as a table. file: the map's. Throws Error(kIo).
void write_map_report(const std::filesystem::path& path, const std::string& file, const TagMap& map);

}  // namespace apriltrack::app
