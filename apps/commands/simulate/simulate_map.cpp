#include "simulate_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "apriltrack/base/error.h"
#include "apriltrack/sim/map_scene.h"
#include "files/inputs.h"
#include "files/trajectory_input.h"

namespace apriltrack::app {
namespace {

Camera camera_to_render(const SimulateOptions& options) {
  Camera camera = read_camera(options.camera, options.camera_name, options.console);
  if (camera.width == 0)
    throw invalid_input(
        options.camera,
        "does not state the resolution, and there are no images that would: apriltrack camera convert IN OUT "
        "--resolution WIDTHxHEIGHT writes it into a file");
  if (camera.line_delay_s != 0.0) {
    options.console.warning(
        fmt::format("{}: line_delay is {:g} s, but rolling shutters are not rendered: all rows are exposed "
                    "at once, and the "
                    "recording's camera.yaml has no line_delay",
                    options.camera, camera.line_delay_s));
    camera.line_delay_s = 0.0;
  }
  camera.T_this_previous.reset();
  camera.name = "cam0";
  return camera;
}

SampledPath read_path(const SimulateOptions& options) {
  const Trajectory trajectory =
      read_trajectory_input(options.trajectory, {.bag = options.poses, .read = {}}, options.console)
          .trajectory;
  if (trajectory.size() < 2)
    throw invalid_input(options.trajectory,
                        fmt::format("a path needs two poses or more (has {})", trajectory.size()));
  std::vector<SampledPath::Sample> samples;
  for (const TimedPose& pose : trajectory)
    samples.push_back({seconds_between(trajectory.front().timestamp, pose.timestamp), pose.pose});
  return SampledPath(std::move(samples));
}

/// The path is smooth there, too, but nobody has measured it.
void warn_of_gaps(const SimulateOptions& options, const SampledPath& path) {
  constexpr double kGap = 5.0;  // steps
  const double longest_s = path.longest_step_s();
  if (longest_s <= kGap * path.median_step_s()) return;
  options.console.warning(
      fmt::format("{}: the longest step from pose to pose is {:.3g} s, the median {:.3g} s; a smooth curve "
                  "leads over the gap",
                  options.trajectory, longest_s, path.median_step_s()));
}

}  // namespace

Scene scene_of_map(const SimulateOptions& options) {
  const Camera camera = camera_to_render(options);
  const SampledPath path = read_path(options);
  warn_of_gaps(options, path);
  return make_map_scene({.map = read_map_input(options.map, options.map_input, options.console),
                         .camera = camera,
                         .path = path,
                         .truth = options.mode,
                         .speed = options.speed});
}

}  // namespace apriltrack::app
