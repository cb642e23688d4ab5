#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace apriltrack {

/// How long a frame takes: the median of the last intervals. A false time stamp is no measure, nor is a gap.
class FramePace {
 public:
  void add(std::int64_t interval_ns) {
    last_ns_[num_added_ % last_ns_.size()] = interval_ns;
    ++num_added_;
  }

  /// Of an even number the shorter one: of two intervals, the longer may have a gap. Requires an interval.
  std::int64_t frame_interval_ns() const {
    auto sorted_ns = last_ns_;
    const std::size_t count = std::min(num_added_, sorted_ns.size());
    const auto end = sorted_ns.begin() + static_cast<std::ptrdiff_t>(count);
    const auto middle = sorted_ns.begin() + static_cast<std::ptrdiff_t>((count - 1) / 2);
    std::nth_element(sorted_ns.begin(), middle, end);
    return *middle;
  }

 private:
  std::array<std::int64_t, 9> last_ns_ = {};
  std::size_t num_added_ = 0;
};

}  // namespace apriltrack
