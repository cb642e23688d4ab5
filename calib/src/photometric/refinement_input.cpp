#include "photometric/refinement_input.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "apriltrack/base/parallel.h"
#include "apriltrack/calib/map_evidence.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/edge_blur.h"
#include "apriltrack/tags/tag_family.h"
#include "apriltrack/tags/tag_map.h"
#include "observations/place_in_rig.h"
#include "observations/tags_that_hang_together.h"

namespace apriltrack {
namespace {

constexpr double kFirstPsf_px = 0.5;
constexpr std::size_t kLeastMomentsOfTag = 12;
/// Neighbours in time tell how fast the rig moves; farther ones do not.
constexpr double kMostGap_s = 0.25;
constexpr double kMostStreak_px = 3.0;
/// Of a camera's pictures, about so many are as sharp as its lens is.
constexpr double kShareOfSharp = 0.1;

/// A patch of a tag of the map, at a moment whose pose is known.
struct Sighting {
  const TagPatch* patch;
  int map_index;
  int camera;
  std::optional<double> exposure_s;
  std::optional<Detection> detection;  ///< Corners in the patch's own pixels.
  /// What its edges' blur would be a streak of, were the lens in focus: where motion does not tell. Infinite
  /// where they show none.
  std::optional<double> blur_px;
};

struct Moment {
  Timestamp time;
  Pose T_map_rig;
  std::vector<Sighting> sightings;

  std::size_t num_tags() const {
    std::set<int> tags;
    for (const Sighting& one : sightings) tags.insert(one.map_index);
    return tags.size();
  }
};

std::map<TagKey, int> indices_of(const TagMap& map) {
  std::map<TagKey, int> indices;
  for (const MapTag& tag : map.tags) indices.emplace(tag.key, static_cast<int>(indices.size()));
  return indices;
}

int camera_index(const CameraRig& rig, const std::string& name) {
  return static_cast<int>(&rig.find(name) - rig.cameras.data());
}

/// Of an id at two places of one image, neither is known to be the tag.
bool is_seen_once(const FrameDetections& frame, const TagKey& tag) {
  return std::ranges::count(frame.patches, tag, &TagPatch::tag) == 1;
}

std::optional<Detection> detection_in(const TagPatch& patch, const FrameDetections& frame) {
  const auto found = std::ranges::find(frame.detections, patch.tag, &Detection::tag);
  if (found == frame.detections.end()) return std::nullopt;
  Detection detection = *found;
  for (Eigen::Vector2d& corner_px : detection.corners_px) corner_px -= Eigen::Vector2d(patch.x, patch.y);
  return detection;
}

/// In the order of time.
std::vector<Moment> moments_of(const CalibrationResult& calibration, std::span<const FrameDetections> frames,
                               const CameraRig& rig) {
  std::map<Timestamp, Moment> moments;
  for (const RigPose& pose : calibration.rig_poses)
    moments.emplace(pose.timestamp, Moment{pose.timestamp, pose.T_map_rig, {}});
  const std::map<TagKey, int> indices = indices_of(calibration.map);
  for (const FrameDetections& frame : frames) {
    const auto moment = moments.find(frame.timestamp);
    if (moment == moments.end()) continue;
    const int camera = camera_index(rig, frame.camera);
    const Camera& lens = rig.cameras[static_cast<std::size_t>(camera)];
    for (const TagPatch& patch : frame.patches) {
      const auto index = indices.find(patch.tag);
      if (index != indices.end() && is_seen_once(frame, patch.tag))
        moment->second.sightings.push_back({&patch, index->second, camera,
                                            frame.exposure_s ? frame.exposure_s : lens.exposure_s,
                                            detection_in(patch, frame), std::nullopt});
    }
  }
  std::vector<Moment> sorted;
  for (auto& [time, moment] : moments) sorted.push_back(std::move(moment));
  return sorted;
}

/// Evenly spread ones, and others of tags that these show too seldom.
std::vector<bool> choose(const std::vector<Moment>& moments, int max_moments) {
  std::vector<std::size_t> candidates;
  for (std::size_t i = 0; i < moments.size(); ++i) {
    if (moments[i].num_tags() >= 2) candidates.push_back(i);
  }
  std::vector<bool> is_chosen(moments.size(), false);
  std::map<int, std::size_t> num_of_tag;
  const auto take = [&](std::size_t i) {
    if (is_chosen[i]) return;
    is_chosen[i] = true;
    for (const Sighting& one : moments[i].sightings) ++num_of_tag[one.map_index];
  };
  const std::size_t wanted = std::min(candidates.size(), static_cast<std::size_t>(max_moments));
  for (std::size_t k = 0; k < wanted; ++k) take(candidates[k * candidates.size() / wanted]);
  for (const std::size_t i : candidates) {
    const bool is_needed = std::ranges::any_of(moments[i].sightings, [&](const Sighting& one) {
      return num_of_tag[one.map_index] < kLeastMomentsOfTag;
    });
    if (is_needed) take(i);
  }
  return is_chosen;
}

/// Of the rig at moments[i], per second, right perturbation; nullopt where no neighbour is near in time.
std::optional<Vector6d> rate_at(const std::vector<Moment>& moments, std::size_t i) {
  const auto is_near = [&](std::size_t k) {
    return std::abs(seconds_between(moments[i].time, moments[k].time)) < kMostGap_s;
  };
  const std::size_t before = i > 0 && is_near(i - 1) ? i - 1 : i;
  const std::size_t after = i + 1 < moments.size() && is_near(i + 1) ? i + 1 : i;
  if (before == after) return std::nullopt;
  const double dt_s = seconds_between(moments[before].time, moments[after].time);
  return Vector6d((moments[before].T_map_rig.inverse() * moments[after].T_map_rig).log() / dt_s);
}

/// Of tags whose motion during the exposure nobody tells, at a moment whose rig moves at `rate`.
void measure_blur(const CameraRig& rig, bool has_rate, Moment& moment) {
  for (Sighting& one : moment.sightings) {
    if ((has_rate && one.exposure_s) || !one.detection) continue;
    const auto sigma_px = edge_blur_sigma_px(
        one.patch->pixels.view(), rig.cameras[static_cast<std::size_t>(one.camera)].response, *one.detection);
    one.blur_px = sigma_px ? motion_of_blur_px(*sigma_px) : std::numeric_limits<double>::infinity();
  }
}

/// Of each camera: how blurred its sharpest pictures are, as Sighting::blur_px. A lens out of focus is no
/// motion.
std::vector<double> blur_of_lenses(const std::vector<Moment>& moments, std::size_t num_cameras) {
  std::vector<std::vector<double>> blurs_px(num_cameras);
  for (const Moment& moment : moments) {
    for (const Sighting& one : moment.sightings) {
      if (one.blur_px) blurs_px[static_cast<std::size_t>(one.camera)].push_back(*one.blur_px);
    }
  }
  std::vector<double> sharp_px;
  for (std::vector<double>& of_camera : blurs_px) {
    std::ranges::sort(of_camera);
    const auto place = static_cast<std::size_t>(kShareOfSharp * static_cast<double>(of_camera.size()));
    sharp_px.push_back(of_camera.empty() ? 0.0 : of_camera[place]);
  }
  return sharp_px;
}

/// Way of the tag's centre in the image during the exposure.
std::optional<Eigen::Vector2d> streak_px(const Camera& camera, const Pose& T_camera_rig,
                                         const Pose& T_map_rig, const Pose& T_map_tag, const Vector6d& way) {
  const auto seen = [&](double share) {
    return camera.model.project(
        (T_camera_rig * (T_map_rig * Pose::exp(share * way)).inverse() * T_map_tag).translation());
  };
  const auto opening = seen(-0.5), closing = seen(0.5);
  if (!opening || !closing) return std::nullopt;
  return *closing - *opening;
}

/// Tags of the scene are those that are seen in two moments or more: `place` of each in the scene, by its
/// place in the map.
std::map<int, int> places_in_scene(const std::vector<Moment>& moments, const std::vector<bool>& is_chosen) {
  std::map<int, int> counts, places;
  for (std::size_t i = 0; i < moments.size(); ++i) {
    for (const Sighting& one : moments[i].sightings) counts[one.map_index] += is_chosen[i] ? 1 : 0;
  }
  for (const auto& [index, count] : counts) {
    if (count >= 2) places.emplace(index, static_cast<int>(places.size()));
  }
  return places;
}

void add_tag(const MapTag& tag, int map_index, RefinementInput& input) {
  const TagPattern pattern = TagFamily::get(tag.key.family).pattern(tag.key.id);
  input.scene.tags.push_back({pattern, 0.5 * tag.size_m});
  input.start.T_map_tag.push_back(tag.T_map_tag);
  input.start.lights.emplace_back(pattern.half_extent(), pattern.cells().width());
  input.map_index.push_back(map_index);
}

/// What moves the rig, and what blurs pictures without.
struct Motion {
  std::optional<Vector6d> rate;
  const std::vector<double>& lens_blur_px;
};

/// The streak of the view, zero where only its blur is known; nullopt where it smears.
std::optional<Eigen::Vector2d> short_streak_px(const Sighting& one, const Moment& moment,
                                               const Motion& motion, const Pose& T_map_tag,
                                               const RefinementInput& input) {
  const auto camera = static_cast<std::size_t>(one.camera);
  if (!motion.rate || !one.exposure_s) {
    const double lens_px = motion.lens_blur_px[camera];
    const double blur_px = one.blur_px.value_or(0.0);  // variances add
    if (!(blur_px * blur_px - lens_px * lens_px < kMostStreak_px * kMostStreak_px)) return std::nullopt;
    return Eigen::Vector2d(Eigen::Vector2d::Zero());
  }
  const auto streak = streak_px(input.scene.cameras[camera], input.scene.T_camera_rig[camera],
                                moment.T_map_rig, T_map_tag, *one.exposure_s * *motion.rate);
  if (!streak || !(streak->norm() < kMostStreak_px)) return std::nullopt;
  return streak;
}

/// The views of one moment, but for those that smear or show too little.
std::vector<PhotometricView> views_of(const Moment& moment, const Motion& motion,
                                      const std::map<int, int>& places, const RefinementInput& input) {
  std::vector<PhotometricView> views;
  for (const Sighting& one : moment.sightings) {
    const auto place = places.find(one.map_index);
    if (place == places.end()) continue;
    const auto camera = static_cast<std::size_t>(one.camera), tag = static_cast<std::size_t>(place->second);
    const Pose& T_map_tag = input.start.T_map_tag[tag];
    const auto streak = short_streak_px(one, moment, motion, T_map_tag, input);
    if (!streak) continue;
    PhotometricView view{.tag = place->second, .camera = one.camera, .streak_px = *streak};
    const Pose T_camera_tag = input.scene.T_camera_rig[camera] * moment.T_map_rig.inverse() * T_map_tag;
    if (read_pixels(*one.patch, input.scene.cameras[camera], input.scene.tags[tag], T_camera_tag,
                    kFirstPsf_px, view))
      views.push_back(std::move(view));
  }
  return views;
}

/// Those of tags that can be solved for together, with the moments that show them.
void take_views(const std::vector<Moment>& moments, std::vector<std::vector<PhotometricView>> views,
                int held_tag, RefinementInput& input) {
  std::vector<TagAtMoment> seen;
  for (std::size_t i = 0; i < moments.size(); ++i) {
    for (const PhotometricView& view : views[i]) seen.push_back({view.tag, static_cast<int>(i)});
  }
  const HangingTogether together = tags_that_hang_together(seen, held_tag);
  std::size_t next = 0;
  for (std::size_t i = 0; i < moments.size(); ++i) {
    bool is_new = true;
    for (PhotometricView& view : views[i]) {
      if (!together.is_in[next++]) continue;
      if (is_new) input.start.T_map_rig.push_back(moments[i].T_map_rig);
      is_new = false;
      view.moment = static_cast<int>(input.start.T_map_rig.size()) - 1;
      input.scene.views.push_back(std::move(view));
    }
  }
  input.num_moments = static_cast<int>(input.start.T_map_rig.size());
}

void set_cameras(const std::vector<Moment>& moments, const CameraRig& rig, RefinementInput& input) {
  input.scene.cameras = rig.cameras;
  input.scene.T_camera_rig.resize(rig.cameras.size());
  input.start.psf_sigma_px.assign(rig.cameras.size(), kFirstPsf_px);
  std::set<int> used;
  for (const Moment& moment : moments) {
    for (const Sighting& one : moment.sightings) used.insert(one.camera);
  }
  for (const int camera : used) {
    const auto c = static_cast<std::size_t>(camera);
    input.scene.T_camera_rig[c] = place_in_rig(rig, c, used.size() > 1);
  }
}

}  // namespace

RefinementInput refinement_input(const CalibrationResult& calibration,
                                 std::span<const FrameDetections> frames, const CameraRig& rig,
                                 int max_moments, const ParallelFor& parallel) {
  RefinementInput input;
  std::vector<Moment> moments = moments_of(calibration, frames, rig);
  set_cameras(moments, rig, input);
  const std::vector<bool> is_chosen = choose(moments, max_moments);
  const std::map<int, int> places = places_in_scene(moments, is_chosen);
  for (const auto& [map_index, place] : places) {
    const MapTag& tag = calibration.map.tags[static_cast<std::size_t>(map_index)];
    if (tag.key == calibration.held_tag) input.held_tag = place;
    add_tag(tag, map_index, input);
  }
  parallel(moments.size(), [&](std::size_t i) {
    if (is_chosen[i]) measure_blur(rig, rate_at(moments, i).has_value(), moments[i]);
  });
  const std::vector<double> lens_blur_px = blur_of_lenses(moments, rig.cameras.size());
  std::vector<std::vector<PhotometricView>> views(moments.size());
  parallel(moments.size(), [&](std::size_t i) {
    if (is_chosen[i]) views[i] = views_of(moments[i], {rate_at(moments, i), lens_blur_px}, places, input);
  });
  take_views(moments, std::move(views), input.held_tag, input);
  return input;
}

}  // namespace apriltrack
