#include "calibrate_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>

#include "apriltrack/geometry/planar_pnp.h"
#include "map_scene.h"

namespace apriltrack::app {
namespace {

enum CalibratedTag : std::size_t { kSound, kOfGauge, kDoubtful, kNotInMap };

using PosesOfTags = std::map<TagKey, std::vector<Pose>>;

/// The pose whose place is nearest to all others'.
Pose most_central(const std::vector<Pose>& poses) {
  double least = std::numeric_limits<double>::infinity();
  Pose best;
  for (const Pose& one : poses) {
    double sum = 0.0;
    for (const Pose& other : poses) sum += (one.translation() - other.translation()).norm();
    if (sum < least) {
      least = sum;
      best = one;
    }
  }
  return best;
}

/// T_map_tag by each view of a tag that is left out; not more than are needed.
void add_views(const CalibrateRun& run, const FrameDetections& frame, const Pose& T_map_rig,
               PosesOfTags& poses) {
  constexpr std::size_t kEnoughViews = 200;
  const CameraRig& rig = run.result.rig;
  const auto camera = std::ranges::find(rig.cameras, frame.camera, &Camera::name);
  if (camera == rig.cameras.end()) return;
  const Pose T_map_camera =
      T_map_rig * rig.T_camera_rig(static_cast<std::size_t>(camera - rig.cameras.begin())).inverse();
  for (const Detection& detection : frame.detections) {
    if (!std::ranges::binary_search(run.result.left_out, detection.tag)) continue;
    std::vector<Pose>& of_tag = poses[detection.tag];
    const auto size_m = run.sizes.find(detection.tag);
    const auto rays = corner_rays(camera->model, detection.corners_px);
    if (!size_m || !rays || of_tag.size() >= kEnoughViews) continue;
    const PlanarPoses T_camera_tag = solve_planar_pnp(*rays, *size_m);
    if (!T_camera_tag.empty()) of_tag.push_back(T_map_camera * T_camera_tag[0].T_camera_tag);
  }
}

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

std::vector<MapTag> place_left_out_tags(const CalibrateRun& run) {
  std::map<std::int64_t, const Pose*> moments;
  for (const RigPose& moment : run.result.evidence.moments) moments[moment.timestamp.ns] = &moment.T_map_rig;
  PosesOfTags poses;
  for (const FrameDetections& frame : run.sightings.frames)
    if (const auto moment = moments.find(frame.timestamp.ns); moment != moments.end())
      add_views(run, frame, *moment->second, poses);
  std::vector<MapTag> tags;
  for (const auto& [key, of_tag] : poses)
    if (!of_tag.empty())
      tags.push_back({key, *run.sizes.find(key), most_central(of_tag), std::nullopt, std::nullopt, {}});
  return tags;
}

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
