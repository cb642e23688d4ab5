#pragma once

#include <cstddef>
#include <optional>

#include "apriltrack/base/timestamp.h"
#include "frame_pace.h"

namespace apriltrack {

/// Counts the frames of a recording by their time stamps, for a motion model whose time is frames: those that
/// are missing count all the same.
class FrameSteps {
 public:
  struct Step {
    std::size_t count = 1;  ///< Frames since the last, at least this one.
    bool is_anew = false;   ///< Time runs backwards: another recording.
  };

  Step advance(Timestamp time);

 private:
  std::size_t steps_in(std::int64_t interval_ns);

  std::optional<Timestamp> time_;  ///< Of the last frame.
  FramePace pace_;                 ///< The camera's: it outlasts the recording.
  double excess_frames_ = 0.0;     ///< Steps taken at the last frame beyond the time it took.
};

}  // namespace apriltrack
