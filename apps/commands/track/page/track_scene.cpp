#include <fmt/format.h>

#include <algorithm>

#include "apriltrack/eval/run_statistics.h"
#include "apriltrack/report/map_elevation.h"
#include "apriltrack/report/map_scene.h"
#include "pages/status_colours.h"
#include "pages/upward.h"
#include "track_drawings.h"

namespace apriltrack::app {
namespace {

bool has_moving_camera(const TrackRun& run) {
  return run.arguments.method_options().localizer.mode == TrackMode::kEgo;
}

/// In the order of TagFate.
std::vector<SceneState> fates() {
  return {{"seen", SvgInk::kText},
          {"suspect", SvgInk::kWarning, true},
          {"in view and never seen", SvgInk::kPurpleInk, true},
          {"never in view", SvgInk::kPale}};
}

std::vector<SceneState> statuses() {
  std::vector<SceneState> all;
  for (const TrackStatus status : kTrackStatuses) all.push_back({to_string(status), ink_of_status(status)});
  return all;
}

std::vector<ScenePoint> path_of(const TrackRecord& record) {
  std::vector<ScenePoint> path;
  for (const FrameLogRow& row : record.rows()) {
    path.push_back({seconds_between(record.rows().front().timestamp, row.timestamp), std::nullopt,
                    index_of_status(row.status)});
    if (row.pose) path.back().pose = scene_pose(*row.pose);
  }
  return path;
}

std::vector<ScenePoint> path_of(const Trajectory& truth, Timestamp start) {
  std::vector<ScenePoint> path;
  for (const TimedPose& pose : truth)
    path.push_back({seconds_between(start, pose.timestamp), scene_pose(pose.pose), 0});
  return path;
}

/// Of a ray from the middle of the picture's right edge, or its lower one; no more than can be drawn.
Eigen::Vector2d view_tangents(const Camera& camera) {
  constexpr double kMost = 1.2;
  const auto& pinhole = camera.model.pinhole();
  const auto tangent = [&](const Eigen::Vector2d& pixel, Eigen::Index axis) {
    const auto ray = camera.model.unproject(pixel);
    if (!ray || !(ray->z() > 0.0)) return kMost;
    return std::clamp(std::abs((*ray)[axis] / ray->z()), 0.05, kMost);
  };
  if (camera.width <= 0) return {0.6, 0.45};
  return {tangent({camera.width - 1.0, pinhole.cy}, 0), tangent({pinhole.cx, camera.height - 1.0}, 1)};
}

int frames_of(const std::map<TagKey, int>& frames, const TagKey& tag) {
  const auto found = frames.find(tag);
  return found == frames.end() ? 0 : found->second;
}

SceneTag tag_of_track(const TrackRun& run, const MapTag& tag) {
  SceneTag drawn = scene_tag(run.map, tag, static_cast<std::size_t>(fate_of(run.record, tag.key)));
  drawn.notes.push_back(fmt::format("detected in {} frames", frames_of(run.record.frames_by_tag(), tag.key)));
  if (const int frames = frames_of(run.record.strays(), tag.key); frames > 0)
    drawn.notes.push_back(fmt::format("not where the map has it in {} frames", frames));
  return drawn;
}

Eigen::Vector3d up_of_run(const TrackRun& run) {
  if (!has_moving_camera(run)) return -Eigen::Vector3d::UnitY();
  MapEvidence path;
  for (const TimedPose& pose : run.record.trajectory()) path.moments.push_back({pose.timestamp, pose.pose});
  return upward(run.map, path);
}

}  // namespace

SceneView scene_of_track(const TrackRun& run, const Trajectory& truth) {
  const MapEvidence nothing_seen;
  const MapAssessment nothing_said;
  const Timestamp start = run.record.rows().front().timestamp;
  SceneView scene{.up = up_of_run(run),
                  .tag_states = fates(),
                  .ellipsoid_scale = ellipse_scale_for(
                      {{.map = run.map, .evidence = nothing_seen, .assessment = nothing_said}}),
                  .motion = has_moving_camera(run) ? SceneMotion::kCamera : SceneMotion::kTags,
                  .path_states = statuses(),
                  .path_name = "frames",
                  .path = path_of(run.record),
                  .true_path_name = "truth",
                  .true_path = path_of(truth, start),
                  .view_tangents = view_tangents(run.camera)};
  if (!has_moving_camera(run))
    scene.from = Eigen::Vector3d(-0.7, -0.5, -1.0);  // over the camera's left shoulder
  for (const MapTag& tag : run.map.tags) scene.tags.push_back(tag_of_track(run, tag));
  return scene;
}

std::string caption_of_track_scene(const TrackRun& run) {
  const std::size_t stride = path_stride(run.record.rows().size());
  return fmt::format(
      "{} The slider goes through the frames. Drag to turn, drag with the right button or two fingers to "
      "shift, wheel "
      "or pinch to come nearer (the wheel works once the view was clicked). The open triangle is at a tag's "
      "upper "
      "edge, the stroke points where it faces.{}",
      has_moving_camera(run) ? "The map, with the camera where it was."
                             : "The body, before the camera that saw it.",
      stride == 1 ? "" : fmt::format(" One frame in {} is shown.", stride));
}

}  // namespace apriltrack::app
