#include "left_out_places.h"

#include <algorithm>
#include <limits>
#include <map>

#include "apriltrack/geometry/planar_pnp.h"

namespace apriltrack::app {

namespace {

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

}  // namespace apriltrack::app
