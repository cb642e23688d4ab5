#pragma once

#include <cstddef>
#include <optional>
#include <unordered_map>

#include "apriltrack/tags/tag_map.h"

namespace apriltrack {

/// Where a map's tags are among them, for those who look tags up frame after frame: at the same cost in a map
/// of any size.
class TagIndex {
 public:
  explicit TagIndex(const TagMap& map);

  /// Into TagMap::tags; nullopt when the map does not have the tag.
  std::optional<std::size_t> find(const TagKey& key) const;

 private:
  std::unordered_map<TagKey, std::size_t> positions_;
};

}  // namespace apriltrack
