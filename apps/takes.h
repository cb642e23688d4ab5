#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "apriltrack/detect/detection.h"

namespace apriltrack::app {

/// Brings recordings to one clock.
///
/// Recordings of different cameras share a clock: together they are a take. A camera's second recording is of
/// the second take, whose clock may start anew; then all of that take is moved behind the end of the take
/// before, so that no moments of different takes are taken for one. Whether and how far, can only be said
/// once all recordings are there: of each take the camera that filmed longest counts.
class Takes {
 public:
  /// One recording, or file of detections; where it has several cameras they filmed together.
  void add(std::vector<FrameDetections> frames);

  /// All frames in the order of time, those of one moment in the order of the cameras' names: the same in
  /// whatever order recordings of different cameras were added. Leaves nothing.
  std::vector<FrameDetections> take_all();

 private:
  std::vector<std::vector<FrameDetections>> takes_;
  std::map<std::string, std::size_t> num_takes_;  ///< By camera.
};

}  // namespace apriltrack::app
