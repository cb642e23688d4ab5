// What only a sink can see of the loop over a recording's frames: when Ctrl-C is heard, and what progress
// tells.

#include "files/frame_loop.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>

namespace apriltrack::test {
namespace {

/// Blank images without end: a live camera.
class BlankFrames : public FrameSource {
 public:
  std::optional<SourceFrame> next() override {
    SourceFrame frame;
    frame.pixels = GrayImage(64, 48, 128);
    frame.timestamp = Timestamp{++num_given_ * 100'000'000};
    return frame;
  }
  std::optional<std::size_t> num_frames() const override { return std::nullopt; }
  std::string name() const override { return "blank"; }

 private:
  std::int64_t num_given_ = 0;
};

/// Ctrl-C comes while the sink is at its second frame, in the middle of what is read and detected at once.
/// Ends with the number of frames that the sink saw.
[[noreturn]] void interrupt_in_second_frame() {
  app::install_interrupt_handler();
  BlankFrames source;
  DetectFramesOptions options;
  options.num_threads = 2;
  options.task = "look";
  int num_seen = 0;
  const FrameCounts counts = app::detect_frames(source, options, app::Console(), [&](auto) {
    if (++num_seen == 2) std::raise(SIGINT);
  });
  if (!counts.is_interrupted || counts.readable != static_cast<std::size_t>(num_seen)) num_seen = -1;
  std::_Exit(num_seen);
}

// A process of its own: the signal's flag is never taken back.
TEST(FrameLoopDeathTest, HearsCtrlCAfterEveryFrameAndCountsEachInItsProgress) {
  EXPECT_EXIT(interrupt_in_second_frame(), ::testing::ExitedWithCode(2), "look 2, .*warning: interrupted");
}

}  // namespace
}  // namespace apriltrack::test
