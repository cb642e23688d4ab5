#include "calibrate_scene.h"

#include <fmt/format.h>

#include <vector>

#include "apriltrack/report/map_scene.h"

namespace apriltrack::app {
namespace {

enum CalibratedTag : std::size_t { kSound, kOfGauge, kDoubtful, kNotInMap };

std::vector<ScenePoint> path_of(const MapEvidence& evidence) {
  constexpr double kGap_s = 1.0;  // over which the path is not drawn
  std::vector<ScenePoint> path;
  for (std::size_t i = 0; i < evidence.moments.size(); ++i) {
    const RigPose& moment = evidence.moments[i];
    const double time_s = seconds_between(evidence.moments.front().timestamp, moment.timestamp);
    if (!path.empty() && time_s - path.back().time_s > kGap_s)
      path.push_back({path.back().time_s, std::nullopt, 1});
    path.push_back({time_s, scene_pose(moment.T_map_rig), 0});
  }
  return path;
}

CalibratedTag state_of(const DrawnMap& drawn, const MapTag& tag) {
  if (is_doubtful(drawn, tag)) return kDoubtful;
  return is_held(tag) ? kOfGauge : kSound;
}

}  // namespace

SceneView scene_of_calibration(const DrawnMap& drawn) {
  SceneView scene{.up = up_of(drawn),
                  .tag_states = {{"of the map", SvgInk::kText},
                                 {"held", SvgInk::kGood},
                                 {"doubtful", SvgInk::kWarning},
                                 {"left out", SvgInk::kPurpleInk, true}},
                  .ellipsoid_scale = drawn.ellipse_scale,
                  .motion = drawn.evidence.moments.empty() ? SceneMotion::kNothing : SceneMotion::kCamera,
                  .path_states = {{"used", SvgInk::kSkyInk}, {"not used", SvgInk::kRule}},
                  .path_name = "frames",
                  .path = path_of(drawn.evidence)};
  for (const MapTag& tag : drawn.map.tags)
    scene.tags.push_back(scene_tag(drawn.map, tag, state_of(drawn, tag)));
  for (const MapTag& tag : drawn.left_out) scene.tags.push_back(scene_tag(drawn.map, tag, kNotInMap));
  return scene;
}

std::string caption_of_scene(const DrawnMap& drawn) {
  const std::size_t stride = path_stride(drawn.evidence.moments.size());
  return fmt::format(
      "Drag to turn, drag with the right button or two fingers to shift, wheel or pinch to come nearer (the "
      "wheel "
      "works once the view was clicked). The open triangle is at a tag's upper edge, the stroke points where "
      "it "
      "faces. Point at a tag for its figures.{}",
      stride == 1 ? "" : fmt::format(" Of the path one frame in {} is shown.", stride));
}

}  // namespace apriltrack::app
