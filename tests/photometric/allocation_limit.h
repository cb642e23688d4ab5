#pragma once

#include <cstddef>

namespace apriltrack::test {

/// While it lives, `new` of `bytes` and more throws std::bad_alloc, in every thread: what memory that has run
/// out does, and proof that nothing larger was asked for. Eigen's matrices do not come from `new`. One at a
/// time.
class AllocationLimit {
 public:
  explicit AllocationLimit(std::size_t bytes);
  ~AllocationLimit();
  AllocationLimit(const AllocationLimit&) = delete;
  AllocationLimit& operator=(const AllocationLimit&) = delete;
};

}  // namespace apriltrack::test
