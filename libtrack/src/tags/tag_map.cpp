#include "apriltrack/tags/tag_map.h"

#include <algorithm>

#include "apriltrack/tags/tag_corners.h"

namespace apriltrack {

const MapTag* TagMap::find(const TagKey& key) const {
  const auto tag = std::ranges::find(tags, key, &MapTag::key);
  return tag == tags.end() ? nullptr : &*tag;
}

std::array<Eigen::Vector3d, 4> corners_in_map(const MapTag& tag) {
  auto corners = tag_corners(tag.size_m);
  for (Eigen::Vector3d& corner : corners) corner = tag.T_map_tag * corner;
  return corners;
}

}  // namespace apriltrack
