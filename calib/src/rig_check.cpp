#include "rig_check.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <iterator>
#include <map>
#include <string>
#include <utility>

#include "apriltrack/base/degrees.h"
#include "apriltrack/base/error.h"

namespace apriltrack {
namespace {

constexpr std::size_t kLeastMoments = 5, kMostMoments = 200;
constexpr double kScatters = 4.0;  // of single moments: no mean is trusted
constexpr double kFar_m = 0.05;
constexpr double kFar_rad = 5.0 * kRadPerDeg;
constexpr double kLooksRight = 0.2;  // of what is off as the file has it

/// Each camera's pictures as frames of their own: what they show needs no rig.
struct Apart {
  Observations observations;
  std::map<std::pair<int, int>, int> frame_of;  ///< By frame and camera.
};

Apart take_apart(const Observations& observations, const std::vector<std::size_t>& views) {
  Apart apart{observations, {}};
  for (RigCamera& camera : apart.observations.cameras) camera.T_camera_rig = Pose::identity();
  apart.observations.frames.clear();
  for (const std::size_t v : views) {
    TagView& view = apart.observations.views[v];
    const auto [entry, is_new] =
        apart.frame_of.try_emplace({view.frame, view.camera}, static_cast<int>(apart.frame_of.size()));
    if (is_new)
      apart.observations.frames.push_back(observations.frames[static_cast<std::size_t>(view.frame)]);
    view.frame = entry->second;
  }
  return apart;
}

/// T_camera_other at each moment that both show tags of the part, by other and camera.
std::map<std::pair<int, int>, std::vector<Pose>> relative_places(const Apart& apart, const Part& part,
                                                                 const MapState& state) {
  std::vector<bool> is_placed(apart.observations.frames.size(), false);
  for (const std::size_t v : part.views)
    is_placed[static_cast<std::size_t>(apart.observations.views[v].frame)] = true;
  std::map<std::pair<int, int>, std::vector<Pose>> places;
  for (auto other = apart.frame_of.begin(); other != apart.frame_of.end(); ++other) {
    const auto [moment, camera] = other->first;
    for (auto one = std::next(other); one != apart.frame_of.end() && one->first.first == moment; ++one) {
      const auto f = static_cast<std::size_t>(one->second), g = static_cast<std::size_t>(other->second);
      if (is_placed[f] && is_placed[g])
        places[{camera, one->first.second}].push_back(state.T_map_rig[f].inverse() * state.T_map_rig[g]);
    }
  }
  return places;
}

/// Some of them, in all of the recording.
std::vector<Pose> evenly(const std::vector<Pose>& all) {
  if (all.size() <= kMostMoments) return all;
  std::vector<Pose> some;
  for (std::size_t i = 0; i < kMostMoments; ++i) some.push_back(all[i * all.size() / kMostMoments]);
  return some;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

double turn_rad(const Pose& pose) {
  return Eigen::AngleAxisd(pose.rotation()).angle();
}

/// How far `seen` are from a pose, the median of each: m, rad.
std::pair<double, double> distance_from(const std::vector<Pose>& seen, const Pose& pose) {
  std::vector<double> lengths, turns;
  for (const Pose& one : seen) {
    lengths.push_back((one.translation() - pose.translation()).norm());
    turns.push_back(turn_rad(one * pose.inverse()));
  }
  return {median(lengths), median(turns)};
}

/// The one that is nearest to all others.
Pose middle_of(const std::vector<Pose>& seen) {
  const auto badness = [&](const Pose& one) {
    const auto [length_m, angle_rad] = distance_from(seen, one);
    return length_m + angle_rad;
  };
  return *std::ranges::min_element(seen, {}, badness);
}

/// What users do to a rig, if that is what it was.
std::string guess(const std::vector<Pose>& seen, const Pose& stated) {
  const Eigen::Matrix3d turn = stated.rotation().toRotationMatrix();
  const std::pair<Pose, const char*> mistakes[] = {
      {{turn, stated.translation() / 1000.0}, "its lengths look like millimetres, and must be metres"},
      {{turn, stated.translation() / 100.0}, "its lengths look like centimetres, and must be metres"},
      {stated.inverse(), "it looks like the inverse: of a point in camera n-1 it must make one in camera n"}};
  const auto off = distance_from(seen, stated);
  for (const auto& [pose, words] : mistakes) {
    const auto rest = distance_from(seen, pose);
    if (rest.first <= std::max(kFar_m, kLooksRight * off.first) &&
        rest.second <= std::max(kFar_rad, kLooksRight * off.second))
      return words;
  }
  return "is it of this rig, and are its cameras in this order?";
}

std::string in_words(const Pose& pose) {
  const Eigen::Vector3d& t = pose.translation();
  return fmt::format("[{:.3g}, {:.3g}, {:.3g}] m, turned by {:.1f} degrees", t.x(), t.y(), t.z(),
                     turn_rad(pose) * kDegPerRad);
}

/// seen: T_camera_other, by the pictures of single moments.
void require_place(const RigCamera& other, const RigCamera& camera, const std::vector<Pose>& seen) {
  if (seen.size() < kLeastMoments) return;
  const Pose stated = camera.T_camera_rig * other.T_camera_rig.inverse();
  const Pose middle = middle_of(seen);
  const auto [off_m, off_rad] = distance_from(seen, stated);
  const auto [scatter_m, scatter_rad] = distance_from(seen, middle);
  if (off_m <= kFar_m + kScatters * scatter_m && off_rad <= kFar_rad + kScatters * scatter_rad) return;
  throw no_result("calibrate",
                  fmt::format("T_cn_cnm1 of the camera file does not fit: from {} to {} it says {}, and {} "
                              "moments show {} (within "
                              "about {:.2g} m and {:.1f} degrees); {}",
                              other.name, camera.name, in_words(stated), seen.size(), in_words(middle),
                              scatter_m, scatter_rad * kDegPerRad, guess(seen, stated)));
}

}  // namespace

void require_rig_that_fits(const PartTask& task, const Part& part, int held_tag,
                           const ParallelFor& parallel) {
  const std::vector<RigCamera>& cameras = task.observations.cameras;
  if (cameras.size() < 2) return;
  const Apart apart = take_apart(task.observations, part.views);
  const Part still = connected_to(apart.observations, part.views, held_tag, task.options.min_views);
  if (still.tags.size() < 2) return;
  const std::vector<ViewCandidates> candidates = solve_views(apart.observations, still.views, parallel);
  const MapState state = start_state(apart.observations, still, held_tag, candidates, parallel);
  for (const auto& [pair, seen] : relative_places(apart, still, state))
    require_place(cameras[static_cast<std::size_t>(pair.first)],
                  cameras[static_cast<std::size_t>(pair.second)], evenly(seen));
}

}  // namespace apriltrack
