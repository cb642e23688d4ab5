#include "track_truth.h"

#include <filesystem>

#include "apriltrack/source/frame_source.h"
#include "files/inputs.h"

namespace apriltrack::app {
namespace {
namespace fs = std::filesystem;

bool is_same_place(const fs::path& a, const fs::path& b) {
  std::error_code ignored;
  return fs::equivalent(a, b, ignored);
}

}  // namespace

std::optional<TruthScore> score_against_truth(const TrackArguments& arguments, const Camera& camera,
                                              const TagMap& map, const TrackRecord& record,
                                              bool was_interrupted) {
  const fs::path truth = fs::path(arguments.input) / "truth.tum";
  std::error_code ignored;
  if (arguments.input.empty() || !fs::exists(truth, ignored) || !record.has_pose()) return std::nullopt;
  const auto own_camera = sequence_camera_file(arguments.input);
  const auto own_map = sequence_map_file(arguments.input);
  const CornerScene scene{
      with_resolution_of_images(
          own_camera ? read_camera(*own_camera, arguments.camera_name, Console()) : camera, arguments.input),
      own_map ? read_tag_map(*own_map) : map};
  TruthScore score;
  score.is_map_the_recordings = arguments.map.empty() || (own_map && is_same_place(arguments.map, *own_map));
  Trajectory true_poses = read_tum(truth);
  if (was_interrupted) {
    constexpr double kSameFrame_s = 1e-3;  // as evaluate_trajectory() takes two times for one frame's
    score.untried = std::erase_if(true_poses, [&](const TimedPose& pose) {
      return seconds_between(record.rows().back().timestamp, pose.timestamp) > kSameFrame_s;
    });
  }
  score.evaluation = evaluate_trajectory(
      true_poses, record.trajectory(), &scene,
      {.kind = arguments.mode == "joint" ? TrajectoryKind::kJoint : TrajectoryKind::kEgo});
  score.log = evaluate_frame_log(score.evaluation, record.rows());
  score.truth = std::move(true_poses);
  return score;
}

}  // namespace apriltrack::app
