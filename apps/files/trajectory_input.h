#pragma once

#include <string>

#include "apriltrack/eval/trajectory_formats.h"
#include "apriltrack/source/bag_poses.h"
#include "cli/console.h"

namespace apriltrack::app {

/// What `--topic` and `--transform` of `trajectory convert` and the options of KITTI's times tell.
struct TrajectoryInputOptions {
  BagPoseChoice bag;
  TrajectoryReadOptions read;
};

struct TrajectoryInput {
  Trajectory trajectory;
  std::string format;  ///< "tum", "euroc", "kitti", "bag".
  std::string title;   ///< For messages.
  std::vector<ConversionLoss> losses;
};

/// A file of a trajectory in any format, or the poses of a bag. Throws as read_trajectory_file() and
/// read_bag_poses() do, and Error(kInvalidInput) where two poses of a bag have one time, or an option is of
/// the other kind of input.
TrajectoryInput read_trajectory_input(const std::string& path, const TrajectoryInputOptions& options,
                                      const Console& console);

}  // namespace apriltrack::app
