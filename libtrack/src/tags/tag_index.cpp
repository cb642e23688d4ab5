#include "apriltrack/tags/tag_index.h"

namespace apriltrack {

TagIndex::TagIndex(const TagMap& map) {
  positions_.reserve(map.tags.size());
  for (std::size_t i = 0; i < map.tags.size(); ++i) positions_.emplace(map.tags[i].key, i);
}

std::optional<std::size_t> TagIndex::find(const TagKey& key) const {
  const auto found = positions_.find(key);
  if (found == positions_.end()) return std::nullopt;
  return found->second;
}

}  // namespace apriltrack
