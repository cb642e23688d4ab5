#include "apriltrack/base/disjoint_sets.h"

#include <algorithm>
#include <numeric>

namespace apriltrack {

DisjointSets::DisjointSets(std::size_t count) : parent_(count) {
  std::iota(parent_.begin(), parent_.end(), 0u);
}

std::size_t DisjointSets::find(std::size_t item) {
  while (parent_[item] != item) {
    parent_[item] = parent_[parent_[item]];
    item = parent_[item];
  }
  return item;
}

bool DisjointSets::join(std::size_t a, std::size_t b) {
  const std::size_t root_a = find(a), root_b = find(b);
  if (root_a == root_b) return false;
  parent_[std::max(root_a, root_b)] = std::min(root_a, root_b);
  return true;
}

}  // namespace apriltrack
