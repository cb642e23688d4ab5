#pragma once

#include <cstddef>
#include <vector>

namespace apriltrack {

/// At most `limit` (two or more) of `items`, evenly spread.
template <typename Item>
std::vector<Item> spread_selection(const std::vector<Item>& items, std::size_t limit) {
  if (items.size() <= limit) return items;
  std::vector<Item> selected;
  for (std::size_t i = 0; i < limit; ++i) selected.push_back(items[i * (items.size() - 1) / (limit - 1)]);
  return selected;
}

}  // namespace apriltrack
