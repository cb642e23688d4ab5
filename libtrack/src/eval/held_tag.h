#pragma once

#include <algorithm>
#include <ranges>

#include "apriltrack/tags/tag_map.h"

namespace apriltrack {

/// The element whose tag a map's gauge holds, which it says by a covariance of zeros; nullptr unless there is
/// exactly one. tag_of: from an element to its MapTag.
template <class Elements, class TagOf>
auto find_held(const Elements& elements, const TagOf& tag_of) {
  const auto is_held = [](const MapTag& tag) { return tag.covariance && tag.covariance->isZero(0.0); };
  const auto found = std::ranges::find_if(elements, is_held, tag_of);
  const bool is_one = std::ranges::count_if(elements, is_held, tag_of) == 1;
  return is_one ? &*found : nullptr;
}

}  // namespace apriltrack
