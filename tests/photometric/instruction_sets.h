#pragma once

#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <cstdint>
#include <string>
#include <vector>

namespace apriltrack::test {

/// Those that the kernels are built for and this machine has, and the one without SIMD.
inline std::vector<std::int64_t> instruction_sets() {
  hwy::SetSupportedTargetsForTest(0);
  std::vector<std::int64_t> sets;
  for (std::int64_t left = hwy::SupportedTargets() & HWY_TARGETS; left != 0; left &= left - 1)
    sets.push_back(left & -left);
  return sets;
}

/// Runs kernels on that one while it lives.
class InstructionSet {
 public:
  explicit InstructionSet(std::int64_t set) { hwy::SetSupportedTargetsForTest(set); }
  ~InstructionSet() { hwy::SetSupportedTargetsForTest(0); }
  InstructionSet(const InstructionSet&) = delete;
  InstructionSet& operator=(const InstructionSet&) = delete;
};

inline std::string instruction_set_name(const testing::TestParamInfo<std::int64_t>& set) {
  return hwy::TargetName(set.param);
}

}  // namespace apriltrack::test
