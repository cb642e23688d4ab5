#include "mapped_detector.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "apriltrack/base/error.h"
#include "apriltrack/tags/tag_family.h"

namespace apriltrack {

DetectorOptions detector_options_for(const Camera& camera, const TagMap& map,
                                     const DetectorOptions& options) {
  if (map.tags.empty()) throw invalid_input("map", "has no tags: nothing to localise by");
  DetectorOptions result = options;
  result.families.clear();
  for (const MapTag& tag : map.tags) {
    if (!TagFamily::is_known(tag.key.family)) {
      throw invalid_input("map", fmt::format("tag {}: unknown family; known are {}", to_string(tag.key),
                                             fmt::join(TagFamily::names(), ", ")));
    }
    if (std::find(result.families.begin(), result.families.end(), tag.key.family) == result.families.end())
      result.families.push_back(tag.key.family);
  }
  result.response = camera.response;
  return result;
}

}  // namespace apriltrack
