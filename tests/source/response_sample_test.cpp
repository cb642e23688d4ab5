// Which frames a camera's response is asked of before a run.

#include "apriltrack/source/response_sample.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <set>

#include "response_rounds.h"

namespace apriltrack {
namespace {

/// Frames of the recording that SourceOptions name.
std::vector<std::size_t> frames_named(const SourceOptions& options, std::size_t most) {
  std::vector<std::size_t> frames;
  for (std::size_t i = options.skip; i < most && frames.size() < *options.max_frames; i += options.step)
    frames.push_back(i);
  return frames;
}

TEST(ResponseSample, LooksAtNoFrameTwice) {
  const SourceOptions run = {.skip = 5, .step = 3};
  int with_four_rounds = 0;
  for (std::size_t count = 1; count <= 200; ++count) {
    const std::size_t end = run.skip + count * run.step;
    for (std::size_t first = 1; first <= count; ++first) {
      std::set<std::size_t> seen;
      int rounds = 0;
      for (int round = 0; round < kSampleRounds; ++round) {
        const auto some = frames_of_round(run, count, round, first);
        if (!some) continue;
        ++rounds;
        for (const std::size_t frame : frames_named(*some, end)) {
          EXPECT_EQ((frame - run.skip) % run.step, 0U) << "the run does not look at it";
          EXPECT_TRUE(seen.insert(frame).second)
              << "frame " << frame << " twice, of " << count << ", " << first << " at first";
        }
      }
      EXPECT_FALSE(seen.empty());
      with_four_rounds += rounds == kSampleRounds;
      if (HasFailure()) return;
    }
  }
  EXPECT_GT(with_four_rounds, 1000);
}

TEST(ResponseSample, LeavesCamerasAndPipesToTheRun) {
  const std::filesystem::path pipe = std::filesystem::path(::testing::TempDir()) / "response_sample.pipe";
  std::filesystem::remove(pipe);
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  for (const std::string& input : {std::string("camera:250"), pipe.string()}) {
    const SampledInput sampled{input, {}};
    ResponseFinding finding;
    // Whoever opens these hears that there is no such camera, or waits for a writer until the test's time is
    // over.
    EXPECT_NO_THROW(finding = response_of_sample({&sampled, 1}, {}, {}, TagSizes(), 1)) << input;
    EXPECT_EQ(finding.origin, ResponseOrigin::kAssumed);
  }
  std::filesystem::remove(pipe);
}

}  // namespace
}  // namespace apriltrack
