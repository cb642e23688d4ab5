#pragma once

#include <cstddef>
#include <vector>

namespace apriltrack {

/// Sets that grow together (Tarjan's union-find, with path halving).
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count);
  std::size_t find(std::size_t item);
  /// False when both were in one set already.
  bool join(std::size_t a, std::size_t b);

 private:
  std::vector<std::size_t> parent_;
};

}  // namespace apriltrack
