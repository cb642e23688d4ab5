#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "apriltrack/tags/map_oddities.h"
#include "cli/console.h"

namespace apriltrack::app {

/// Warns of what looks like a mistake of units.
void tell_oddities(const TagMap& map, const std::string& file, const Console& console);

/// `oddities` of map show and map convert: kind, tags and value_m of each.
nlohmann::json oddities_json(const TagMap& map);

}  // namespace apriltrack::app
