#pragma once

#include <string>

#include "apriltrack/eval/trajectory.h"

namespace apriltrack::app {

/// `track --output -`: a line of a TUM file on stdout for each pose, as soon as it is known.
class PoseStream {
 public:
  /// goes_on: whether a reader that goes away ends nothing yet, for other files are written as well.
  explicit PoseStream(bool goes_on) : goes_on_(goes_on) {}

  /// Throws Error(kIo) where nobody can read it any more, unless the run goes on.
  void add(const TimedPose& pose);
  /// At the end: throws Error(kIo) where a line was not read.
  void close() const;

 private:
  const bool goes_on_;
  bool is_broken_ = false;
};

}  // namespace apriltrack::app
