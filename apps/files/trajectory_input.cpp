#include "trajectory_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "apriltrack/base/error.h"
#include "apriltrack/source/bag_input.h"
#include "inputs.h"

namespace apriltrack::app {
namespace {

Trajectory sorted(const std::vector<BagPose>& poses, const std::string& path) {
  Trajectory trajectory;
  for (const BagPose& pose : poses) trajectory.push_back({pose.timestamp, pose.pose});
  std::ranges::stable_sort(trajectory, {}, &TimedPose::timestamp);
  const auto twin = std::ranges::adjacent_find(trajectory, {}, &TimedPose::timestamp);
  if (twin != trajectory.end())
    throw invalid_input(path, fmt::format("has two poses of the time {} s; each frame has one",
                                          format_seconds(twin->timestamp)));
  return trajectory;
}

TrajectoryInput read_bag(const std::string& path, const TrajectoryInputOptions& options,
                         const Console& console) {
  if (!options.read.times.empty() || options.read.rate_hz)
    throw invalid_input(options.read.rate_hz ? "--rate" : "--times",
                        fmt::format("is of KITTI's poses, and {} is a bag: leave it out", path));
  return {sorted(read_bag_poses(path, options.bag, console.log()), path), "bag", "bag", {}};
}

TrajectoryInput read_any(const std::string& path, const TrajectoryInputOptions& options,
                         const Console& console) {
  if (is_bag_input(path)) return read_bag(path, options, console);
  for (const auto& [option, value] :
       {std::pair{"--topic", &options.bag.topic}, std::pair{"--transform", &options.bag.transform}})
    if (!value->empty())
      throw invalid_input(option, fmt::format("is of a bag, and '{}' is none: leave it out", path));
  TrajectoryReading reading = read_trajectory_file(path, options.read);
  const TrajectoryFormatInfo& info = info_of(reading.format);
  return {std::move(reading.trajectory), std::string(info.name), std::string(info.title),
          std::move(reading.losses)};
}

}  // namespace

TrajectoryInput read_trajectory_input(const std::string& path, const TrajectoryInputOptions& options,
                                      const Console& console) {
  check_input(path);
  TrajectoryInput input = read_any(path, options, console);
  if (input.trajectory.empty()) throw invalid_input(path, "has no poses: a trajectory needs one at least");
  return input;
}

}  // namespace apriltrack::app
