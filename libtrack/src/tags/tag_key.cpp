#include "apriltrack/tags/tag_key.h"

#include <limits>

#include "apriltrack/io/numbers.h"

namespace apriltrack {

std::string to_string(const TagKey& key) {
  return key.family + "/" + std::to_string(key.id);
}

std::optional<TagKey> parse_tag_key(std::string_view text) {
  const std::size_t slash = text.find('/');
  const bool has_family = slash != std::string_view::npos;
  const std::string_view digits = has_family ? text.substr(slash + 1) : text;
  const auto id = parse_integer(digits);
  if (!id || *id < 0 || *id > std::numeric_limits<int>::max() || std::to_string(*id) != digits)
    return std::nullopt;
  return TagKey{std::string(has_family ? text.substr(0, slash) : ""), static_cast<int>(*id)};
}

}  // namespace apriltrack
