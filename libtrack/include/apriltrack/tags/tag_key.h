#pragma once

#include <compare>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace apriltrack {

/// What identifies a tag: the same id of another family is another tag.
struct TagKey {
  std::string family = "tag36h11";
  int id = 0;

  auto operator<=>(const TagKey&) const = default;
};

/// "tag36h11/7".
std::string to_string(const TagKey& key);

/// "7", whose family is left empty, or "tag36h11/7"; nullopt for an id that is not written as to_string()
/// does
/// ("07", "+7", "7.0", "-1"). Whether there is such a tag, fault_of_key() says.
std::optional<TagKey> parse_tag_key(std::string_view text);

}  // namespace apriltrack
/// @cond
template <>
struct std::hash<apriltrack::TagKey> {
  std::size_t operator()(const apriltrack::TagKey& key) const noexcept {
    return std::hash<std::string>()(key.family) * 31 + static_cast<std::size_t>(key.id);
  }
};
/// @endcond
