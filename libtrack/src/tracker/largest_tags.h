#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "apriltrack/motion/motion_state.h"
#include "apriltrack/photometric/photometric_world.h"

namespace apriltrack {

/// While it lives, no more than kMaxInSight of the tags that a state sees are looked at, the largest: for a
/// search of where they are, a dozen tell as well as a whole board does, and its time grows with each.
class LargestTags {
 public:
  static constexpr std::size_t kMaxInSight = 12;

  /// world: must outlive it.
  LargestTags(PhotometricWorld& world, std::span<const MotionState> states);
  ~LargestTags();
  LargestTags(const LargestTags&) = delete;
  LargestTags& operator=(const LargestTags&) = delete;

 private:
  PhotometricWorld& world_;
  std::vector<std::size_t> left_out_;
};

}  // namespace apriltrack
