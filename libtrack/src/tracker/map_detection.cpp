#include "map_detection.h"

#include <algorithm>

#include "apriltrack/detect/estimate_response.h"

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
  check_tag_map(map);
  options.families = families_of(map);
  options.response = camera.response;
  options.rival_response = rival_response(camera.response, camera.response_origin);
  options.camera_model = camera.model;
  return options;
}

}  // namespace apriltrack
