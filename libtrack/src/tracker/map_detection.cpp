#include "map_detection.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "apriltrack/base/error.h"
#include "apriltrack/tags/tag_family.h"

namespace apriltrack {
namespace {

/// Families in the map's order of first use.
std::vector<std::string> families_of(const TagMap& map) {
  std::vector<std::string> families;
  for (const MapTag& tag : map.tags) {
    if (std::find(families.begin(), families.end(), tag.key.family) == families.end()) {
      families.push_back(tag.key.family);
    }
  }
  return families;
}

}  // namespace

DetectorOptions detector_options_for(const Camera& camera, const TagMap& map, DetectorOptions options) {
  if (map.tags.empty()) throw invalid_input("map", "has no tags: nothing to localise by");
  for (const MapTag& tag : map.tags) {
    if (TagFamily::is_known(tag.key.family)) continue;
    throw invalid_input("map", fmt::format("tag {}: unknown family; known are {}", to_string(tag.key),
                                           fmt::join(TagFamily::names(), ", ")));
  }
  options.families = families_of(map);
  options.response = camera.response;
  return options;
}

}  // namespace apriltrack
