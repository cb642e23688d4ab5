#include "mirror_test.h"

#include <algorithm>
#include <numbers>
#include <set>

#include "bundle_adjustment.h"
#include "tag_links.h"

namespace apriltrack {
namespace {

constexpr std::size_t kMaxFrames = 12;
// Of the robust cost: a turn that only follows the noise gains a few percent, the right one most of it.
constexpr double kClearlyLower = 0.8;
// A mirrored tag is reflected about ONE line of sight: seen from 35 degrees off it, it is wrong by up to 70
// degrees, tens of pixels, which no fit explains. Skipping such tags only saves time.
constexpr double kDecidedSpread_rad = 35.0 * std::numbers::pi / 180.0;
constexpr double kLossScale = 30.0;

/// Unit directions from the tag to the cameras, in the tag's frame.
std::vector<Eigen::Vector3d> view_directions(const Observations& observations,
                                             const std::vector<std::size_t>& views, const MapState& state) {
  std::vector<Eigen::Vector3d> directions;
  for (const std::size_t v : views) {
    const TagView& view = observations.views[v];
    const Pose T_rig_camera =
        observations.cameras[static_cast<std::size_t>(view.camera)].T_camera_rig.inverse();
    const Pose T_tag_camera = state.T_map_tag[static_cast<std::size_t>(view.tag)].inverse() *
                              state.T_map_rig[static_cast<std::size_t>(view.frame)] * T_rig_camera;
    directions.push_back(T_tag_camera.translation().normalized());
  }
  return directions;
}

Eigen::Vector3d mean_direction(const std::vector<Eigen::Vector3d>& directions) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& direction : directions) sum += direction;
  return sum.normalized();
}

/// Two frames or more from well apart directions leave one pose only.
bool is_decided(const std::vector<Eigen::Vector3d>& directions, const Eigen::Vector3d& mean) {
  const auto far = std::count_if(directions.begin(), directions.end(), [&](const Eigen::Vector3d& direction) {
    return direction.dot(mean) < std::cos(kDecidedSpread_rad);
  });
  return far >= 2;
}

/// All the part's views in (a selection of) the frames that show the tag.
std::vector<std::size_t> neighbourhood(const Observations& observations, const Part& part,
                                       const std::vector<std::size_t>& tag_views) {
  std::set<int> frames;
  for (const std::size_t v : spread_selection(tag_views, kMaxFrames))
    frames.insert(observations.views[v].frame);
  std::vector<std::size_t> views;
  for (const std::size_t v : part.views) {
    if (frames.contains(observations.views[v].frame)) views.push_back(v);
  }
  return views;
}

bool turn_if_better(const Observations& observations, const Part& part, int tag,
                    const std::vector<std::size_t>& tag_views, MapState& state) {
  const std::vector<Eigen::Vector3d> directions = view_directions(observations, tag_views, state);
  const Eigen::Vector3d toward_viewer = mean_direction(directions);
  if (is_decided(directions, toward_viewer)) return false;

  const std::vector<std::size_t> views = neighbourhood(observations, part, tag_views);
  const AdjustmentOptions options{.loss_scale = kLossScale, .max_iterations = 30};
  MapState as_is = state, turned = state;
  Pose& pose = turned.T_map_tag[static_cast<std::size_t>(tag)];
  pose = mirrored_about(pose, pose.rotation() * toward_viewer);
  const AdjustmentSummary before = adjust(observations, views, {tag}, options, as_is);
  const AdjustmentSummary after = adjust(observations, views, {tag}, options, turned);
  if (!after.is_usable || (before.is_usable && after.cost > kClearlyLower * before.cost)) return false;
  state = turned;
  return true;
}

}  // namespace

Pose mirrored_about(const Pose& T_frame_tag, const Eigen::Vector3d& direction) {
  const Eigen::Vector3d d = direction.normalized();
  const Eigen::Matrix3d reflection = Eigen::Matrix3d::Identity() - 2.0 * d * d.transpose();
  const Eigen::Matrix3d R = T_frame_tag.rotation_matrix();
  Eigen::Matrix3d mirrored;
  mirrored.col(0) = reflection * R.col(0);
  mirrored.col(1) = reflection * R.col(1);
  mirrored.col(2) = mirrored.col(0).cross(mirrored.col(1));
  return {mirrored, T_frame_tag.translation()};
}

std::vector<int> turn_mirrored_tags(const Observations& observations, const Part& part, int held_tag,
                                    MapState& state) {
  std::vector<int> turned;
  for (const int tag : part.tags) {
    std::vector<std::size_t> views;
    for (const std::size_t v : part.views) {
      if (observations.views[v].tag == tag) views.push_back(v);
    }
    if (!views.empty() && turn_if_better(observations, part, tag, views, state)) turned.push_back(tag);
  }
  move_origin_to(state, held_tag);
  return turned;
}

}  // namespace apriltrack
