#include "frame_steps.h"

#include <algorithm>
#include <cmath>

namespace apriltrack {
namespace {

constexpr std::size_t kMaxFramesAtOnce = 15;

}  // namespace

FrameSteps::Step FrameSteps::advance(Timestamp time) {
  Step step;
  if (time_ && time.ns < time_->ns) {
    step.is_anew = true;
    excess_frames_ = 0.0;
  } else if (time_) {
    step.count = steps_in(time.ns - time_->ns);
  }
  time_ = time;
  return step;
}

/// What a frame with a false time stamp came too early is missing from its interval and too much in the next:
/// it is not counted twice.
std::size_t FrameSteps::steps_in(std::int64_t interval_ns) {
  if (interval_ns == 0) return 1;  // tells no pace
  pace_.add(interval_ns);
  const double frames = static_cast<double>(interval_ns) / static_cast<double>(pace_.frame_interval_ns());
  const double steps =
      std::clamp(std::round(frames - excess_frames_), 1.0, static_cast<double>(kMaxFramesAtOnce));
  excess_frames_ = std::max(0.0, steps - frames);
  return static_cast<std::size_t>(steps);
}

}  // namespace apriltrack
