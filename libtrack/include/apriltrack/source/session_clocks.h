#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "apriltrack/detect/detection.h"

namespace apriltrack {

/// Aligns the clocks of recordings from several sessions (called takes in messages).
///
/// All recordings share one clock and keep their times, unless one camera would have filmed twice at one
/// time: if two recordings of one camera overlap, the clocks were restarted between sessions. Then the k-th
/// recording of the camera with most recordings belongs to session k. A recording of a camera with fewer
/// belongs to the session that its times overlap, if these and the order of that camera's recordings leave
/// only one. A session that does not begin after the end of the session before is moved as a whole to a
/// minute after it.
///
/// The order in which recordings of different cameras are added makes no difference.
class SessionClocks {
 public:
  /// One recording, or file of detections; if it has several cameras, they filmed together. name: what
  /// messages call it. cameras: all of them, also those without frames.
  void add(const std::string& name, const std::set<std::string>& cameras,
           std::vector<FrameDetections> frames);

  struct Aligned {
    std::vector<FrameDetections> frames;  ///< By time, then by the cameras' names.
    std::optional<std::string> warning;   ///< What was moved, and how far in seconds.
  };
  /// Returns the frames of all recordings and forgets them. Throws Error(kInvalidInput) if clocks were
  /// restarted and the session of a recording is ambiguous.
  Aligned align();

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

}  // namespace apriltrack
