#pragma once

#include <string>

#include "apriltrack/io/yaml_reader.h"
#include "apriltrack/tags/tag_map.h"

namespace apriltrack {

/// map.yaml. Complains with line and key.
TagMap own_map_of(const YamlNode& root);

/// The whole file. Requires a map that check_tag_map() lets pass.
std::string own_map_text(const TagMap& map);

}  // namespace apriltrack
