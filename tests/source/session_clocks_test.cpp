// Which recordings share a clock is told by what one camera cannot have done: film twice at one time.

#include "apriltrack/source/session_clocks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apriltrack/base/error.h"

namespace apriltrack {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<FrameDetections> frames(const std::string& camera, const std::vector<std::int64_t>& seconds) {
  std::vector<FrameDetections> all;
  for (const std::int64_t s : seconds) {
    all.emplace_back();
    all.back().timestamp = Timestamp{s * 1'000'000'000};
    all.back().camera = camera;
  }
  return all;
}

std::vector<std::string> times_of(const std::vector<FrameDetections>& all) {
  std::vector<std::string> times;
  for (const FrameDetections& frame : all)
    times.push_back(frame.camera + " " + std::to_string(frame.timestamp.ns / 1'000'000'000));
  return times;
}

TEST(SessionClocks, RecordingsOfOneClockKeepTheirTimes) {
  SessionClocks sessions;
  sessions.add("right", {"cam1"}, frames("cam1", {1, 2}));
  sessions.add("left", {"cam0"}, frames("cam0", {1, 2}));
  sessions.add("later", {"cam0"}, frames("cam0", {5}));
  const SessionClocks::Aligned aligned = sessions.align();
  EXPECT_THAT(times_of(aligned.frames), ElementsAre("cam0 1", "cam1 1", "cam0 2", "cam1 2", "cam0 5"));
  EXPECT_FALSE(aligned.warning);
}

TEST(SessionClocks, ARestartedClockIsMovedAMinuteBehindTheSessionBefore) {
  SessionClocks sessions;
  sessions.add("first", {"cam0"}, frames("cam0", {1, 3}));
  sessions.add("second", {"cam0"}, frames("cam0", {2, 4}));
  const SessionClocks::Aligned aligned = sessions.align();
  EXPECT_THAT(times_of(aligned.frames), ElementsAre("cam0 1", "cam0 3", "cam0 63", "cam0 65"));
  ASSERT_TRUE(aligned.warning);
  EXPECT_THAT(*aligned.warning, HasSubstr("second (cam0) by 61.000000000 s"));
}

TEST(SessionClocks, AnotherCameraMovesWithTheSessionThatItsTimesOverlap) {
  SessionClocks sessions;
  sessions.add("a0", {"cam0"}, frames("cam0", {10, 12}));
  sessions.add("b0", {"cam0"}, frames("cam0", {1, 11}));
  sessions.add("b1", {"cam1"}, frames("cam1", {2, 5}));
  EXPECT_THAT(times_of(sessions.align().frames),
              ElementsAre("cam0 10", "cam0 12", "cam0 72", "cam1 73", "cam1 76", "cam0 82"));
}

TEST(SessionClocks, AnAmbiguousSessionIsRefused) {
  SessionClocks sessions;
  sessions.add("a0", {"cam0"}, frames("cam0", {1, 5}));
  sessions.add("b0", {"cam0"}, frames("cam0", {2, 6}));
  sessions.add("x1", {"cam1"}, frames("cam1", {3, 4}));
  EXPECT_THROW(sessions.align(), Error);
}

}  // namespace
}  // namespace apriltrack
