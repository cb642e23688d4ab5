#include "frame_steps.h"

#include <gtest/gtest.h>

#include <vector>

namespace apriltrack {
namespace {

constexpr std::int64_t kFrame_ns = 33'333'333;

/// Of frames at these times, in frames.
std::vector<std::size_t> steps_at(FrameSteps& steps, const std::vector<double>& times) {
  std::vector<std::size_t> counts;
  for (const double time : times)
    counts.push_back(steps.advance({static_cast<std::int64_t>(time * kFrame_ns)}).count);
  return counts;
}

using Counts = std::vector<std::size_t>;

TEST(FrameSteps, CountsTheFramesThatAreMissing) {
  FrameSteps steps;
  EXPECT_EQ(steps_at(steps, {0, 1, 2, 5, 6, 16, 17}), Counts({1, 1, 1, 3, 1, 10, 1}));
  EXPECT_EQ(steps_at(steps, {117}), Counts({15}));  // no more at once
}

TEST(FrameSteps, CountsAFalseTimeStampOnlyOnce) {
  for (const double false_by : {-0.97, -0.6, -0.1, 0.1, 0.4}) {
    FrameSteps steps;
    EXPECT_EQ(steps_at(steps, {0, 1, 2, 3, 4 + false_by, 5, 6}), Counts({1, 1, 1, 1, 1, 1, 1})) << false_by;
  }
  FrameSteps steps;
  EXPECT_EQ(steps_at(steps, {0, 1, 1, 2}), Counts({1, 1, 1, 1}));  // the same time twice
}

TEST(FrameSteps, StartsAnewWhereTimeRunsBackwardsAndKeepsThePace) {
  FrameSteps steps;
  steps_at(steps, {10, 11, 12});
  const FrameSteps::Step back = steps.advance({0});
  EXPECT_TRUE(back.is_anew);
  EXPECT_EQ(back.count, 1U);
  const FrameSteps::Step next = steps.advance({3 * kFrame_ns});
  EXPECT_FALSE(next.is_anew);
  EXPECT_EQ(next.count, 3U);
}

}  // namespace
}  // namespace apriltrack
