#include "initialise/rig_check.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <iterator>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <utility>

#include "apriltrack/base/degrees.h"
#include "apriltrack/base/error.h"
#include "numerics/upper_median.h"

namespace apriltrack {
namespace {

constexpr std::size_t kLeastPerCamera = 5, kMostPerCamera = 200;
constexpr double kScatters = 4.0;  // of single moments: no mean is trusted
constexpr double kFar_m = 0.05;
constexpr double kFar_rad = 5.0 * kRadPerDeg;
// What lenses may be off by without being of another camera: by so much of a tag's distance a camera seems
// nearer to it, by so much of the focal length turned.
constexpr double kLensError = 0.06;
constexpr double kRefinable = 3.0;  // times as far where places are refined
constexpr double kLooksRight = 0.2;

/// The moments of the part at which two cameras see tags, some of many; their views.
std::vector<std::size_t> joint_views(const Observations& observations, const Part& part) {
  std::map<int, std::set<int>> cameras_of_frame;
  for (const std::size_t v : part.views)
    cameras_of_frame[observations.views[v].frame].insert(observations.views[v].camera);
  std::erase_if(cameras_of_frame, [](const auto& frame) { return frame.second.size() < 2; });
  std::set<int> frames;
  const std::size_t num = std::min(cameras_of_frame.size(), kMostPerCamera);
  auto frame = cameras_of_frame.begin();
  for (std::size_t i = 0, at = 0; i < num; ++i) {
    for (const std::size_t next = i * cameras_of_frame.size() / num; at < next; ++at) ++frame;
    frames.insert(frame->first);
  }
  std::vector<std::size_t> views;
  std::ranges::copy_if(part.views, std::back_inserter(views),
                       [&](std::size_t v) { return frames.contains(observations.views[v].frame); });
  return views;
}

/// Each camera's pictures as frames of their own: what they show needs no rig.
struct Apart {
  Observations observations;
  std::map<std::pair<int, int>, int> frame_of;  ///< By frame and camera.
};

Apart take_apart(const Observations& observations, const std::vector<std::size_t>& views) {
  Apart apart{{observations.tags, observations.sizes_m, {}, observations.cameras, {}}, {}};
  for (RigCamera& camera : apart.observations.cameras) camera.T_camera_rig = Pose::identity();
  for (const std::size_t v : views) {
    TagView view = observations.views[v];
    const auto [entry, is_new] =
        apart.frame_of.try_emplace({view.frame, view.camera}, static_cast<int>(apart.frame_of.size()));
    if (is_new)
      apart.observations.frames.push_back(observations.frames[static_cast<std::size_t>(view.frame)]);
    view.frame = entry->second;
    apart.observations.views.push_back(view);
  }
  return apart;
}

/// A camera as it is seen from another one.
struct SeenPlaces {
  std::vector<Pose> T_camera_other;  ///< At each moment that both show tags of the map.
  std::vector<double> distances_m;   ///< Of these tags.
};

/// By the other camera, and the one.
std::map<std::pair<int, int>, SeenPlaces> seen_places(const Apart& apart, const Part& part,
                                                      const MapState& state) {
  std::map<int, std::vector<double>> distances_m;  // by frame
  for (const std::size_t v : part.views) {
    const TagView& view = apart.observations.views[v];
    const Pose T_rig_tag = state.T_map_rig[static_cast<std::size_t>(view.frame)].inverse() *
                           state.T_map_tag[static_cast<std::size_t>(view.tag)];
    distances_m[view.frame].push_back(T_rig_tag.translation().norm());
  }
  std::map<std::pair<int, int>, SeenPlaces> places;
  for (auto other = apart.frame_of.begin(); other != apart.frame_of.end(); ++other) {
    for (auto one = std::next(other); one != apart.frame_of.end() && one->first.first == other->first.first;
         ++one) {
      if (!distances_m.contains(one->second) || !distances_m.contains(other->second)) continue;
      SeenPlaces& seen = places[{other->first.second, one->first.second}];
      seen.T_camera_other.push_back(state.T_map_rig[static_cast<std::size_t>(one->second)].inverse() *
                                    state.T_map_rig[static_cast<std::size_t>(other->second)]);
      for (const int frame : {one->second, other->second})
        seen.distances_m.insert(seen.distances_m.end(), distances_m[frame].begin(), distances_m[frame].end());
    }
  }
  return places;
}

/// How far `seen` are from a pose, the median of each: m, rad.
std::pair<double, double> distance_from(const std::vector<Pose>& seen, const Pose& pose) {
  std::vector<double> lengths, turns;
  for (const Pose& one : seen) {
    lengths.push_back((one.translation() - pose.translation()).norm());
    turns.push_back(rotation_angle_rad(one.rotation(), pose.rotation()));
  }
  return {upper_median(std::move(lengths)), upper_median(std::move(turns))};
}

/// The one that is nearest to all others.
Pose middle_of(const std::vector<Pose>& seen) {
  const auto badness = [&](const Pose& one) {
    const auto [length_m, angle_rad] = distance_from(seen, one);
    return length_m + angle_rad;
  };
  return *std::ranges::min_element(seen, {}, badness);
}

/// What users do to a rig, if that is what it was: the mistake that leaves least.
std::string guess(const std::vector<Pose>& seen, const Pose& stated) {
  const Eigen::Quaterniond& turn = stated.rotation();
  const std::pair<Pose, const char*> mistakes[] = {
      {{turn, stated.translation() / 1000.0}, "its lengths look like millimetres, and must be metres"},
      {{turn, stated.translation() / 100.0}, "its lengths look like centimetres, and must be metres"},
      {stated.inverse(), "it looks like the inverse: of a point in camera n-1 it must make one in camera n"}};
  const Pose middle = middle_of(seen);
  const double baseline_m = middle.translation().norm();
  const double scatter_m = distance_from(seen, middle).first;
  const double right_m = std::min(0.5 * baseline_m, kLooksRight * baseline_m + 2.0 * scatter_m);
  const auto badness = [&](const auto& mistake) {
    const auto [off_m, off_rad] = distance_from(seen, mistake.first);
    return std::max(off_m / std::max(right_m, 1e-9), off_rad / kFar_rad);
  };
  const auto& best = *std::ranges::min_element(mistakes, {}, badness);
  if (badness(best) < 1.0) return best.second;
  return "is it of this rig, and are its cameras in this order?";
}

std::string in_words(const Pose& pose) {
  const Eigen::Vector3d& t = pose.translation();
  return fmt::format("[{:.3g}, {:.3g}, {:.3g}] m, turned by {:.1f} degrees", t.x(), t.y(), t.z(),
                     rotation_angle_rad(pose.rotation(), Eigen::Quaterniond::Identity()) * kDegPerRad);
}

/// tolerance: times what is allowed for.
void require_place(const RigCamera& other, const RigCamera& camera, const SeenPlaces& places,
                   double tolerance) {
  const std::vector<Pose>& seen = places.T_camera_other;
  if (seen.size() < kLeastPerCamera) return;
  const Pose stated = camera.T_camera_rig * other.T_camera_rig.inverse();
  const Pose middle = middle_of(seen);
  const auto [off_m, off_rad] = distance_from(seen, stated);
  const auto [scatter_m, scatter_rad] = distance_from(seen, middle);
  const double allowed_m = kFar_m + kLensError * upper_median(places.distances_m) + kScatters * scatter_m;
  const double allowed_rad = kFar_rad + kLensError + kScatters * scatter_rad;
  if (off_m <= tolerance * allowed_m && off_rad <= tolerance * allowed_rad) return;
  throw no_result(
      "calibrate",
      fmt::format(
          "T_cn_cnm1 of the camera file does not fit: from {} to {} it says {}, and {} moments show {} "
          "(within about {:.2g} m and {:.1f} degrees); {}",
          other.name, camera.name, in_words(stated), seen.size(), in_words(middle), scatter_m,
          scatter_rad * kDegPerRad, guess(seen, stated)));
}

}  // namespace

void require_rig_that_fits(const PartTask& task, const Part& part) {
  const std::vector<RigCamera>& cameras = task.observations.cameras;
  const Apart apart = take_apart(task.observations, joint_views(task.observations, part));
  if (apart.observations.views.empty()) return;
  const Observations& pictures = apart.observations;
  std::vector<std::size_t> all(pictures.views.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  const std::vector<ViewCandidates> candidates = solve_views(pictures, all, parallel_for(1));
  std::erase_if(all, [&](std::size_t v) { return candidates[v].candidates.empty(); });
  const std::vector<Part> parts = find_parts(pictures, all, task.options.min_views).parts;
  if (parts.empty()) return;
  const Part& map = parts.front();
  const MapState state = start_state(pictures, map, map.tags.front(), candidates, parallel_for(1));
  const auto places = seen_places(apart, map, state);
  const double tolerance = task.options.refine_extrinsics ? kRefinable : 1.0;
  for (const bool are_neighbours : {true, false}) {  // of others the file has no number
    for (const auto& [pair, seen] : places) {
      if ((pair.second - pair.first == 1) == are_neighbours)
        require_place(cameras[static_cast<std::size_t>(pair.first)],
                      cameras[static_cast<std::size_t>(pair.second)], seen, tolerance);
    }
  }
}

}  // namespace apriltrack
