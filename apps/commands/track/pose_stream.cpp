#include "pose_stream.h"

#include <iostream>

#include "apriltrack/base/error.h"

namespace apriltrack::app {

void PoseStream::add(const TimedPose& pose) {
  if (is_broken_) return;
  is_broken_ = !(std::cout << tum_line(pose) << std::flush);
  if (is_broken_ && !goes_on_) close();
}

void PoseStream::close() const {
  if (is_broken_) throw io_error("--output -", "stdout cannot be written: has its reader gone away?");
}

}  // namespace apriltrack::app
