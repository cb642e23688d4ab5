#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "apriltrack/detect/detection.h"

namespace apriltrack::app {

/// Brings recordings to one clock.
///
/// Recordings of all cameras share a clock, and keep their times, unless a camera says otherwise: it cannot
/// have filmed twice at one time. Where two recordings of one camera overlap, clocks began anew, and
/// recordings are of takes: the k-th of the camera with most recordings is of the k-th take. One of a camera
/// with fewer is of the take that its times overlap, where these and the order of its camera's recordings
/// leave but one. A take that does not begin after the take before has ended is moved behind it as a whole.
///
/// In which order recordings of different cameras are added makes no difference.
class Takes {
 public:
  /// One recording, or file of detections; where it has several cameras they filmed together. name: what
  /// messages call it. cameras: counted even where there are no frames of them.
  void add(const std::string& name, const std::set<std::string>& cameras,
           std::vector<FrameDetections> frames);

  struct OneClock {
    std::vector<FrameDetections> frames;  ///< In the order of time, then of the cameras' names.
    std::optional<std::string> warning;   ///< What was moved, and how far.
  };
  /// Leaves nothing. Throws Error(kInvalidInput) when clocks began anew and it cannot be told with which take
  /// a recording goes.
  OneClock take_all();

  struct Span {
    Timestamp first;
    Timestamp last;
  };
  struct Input {
    std::string name;
    std::set<std::string> cameras;
    std::vector<FrameDetections> frames;
    std::optional<Span> span;  ///< None without frames.

    std::optional<Span> span_of(const std::string& camera) const;
  };

 private:
  std::vector<Input> inputs_;
};

}  // namespace apriltrack::app
