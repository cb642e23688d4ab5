#include "observations/observations.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>

#include "apriltrack/base/error.h"
#include "apriltrack/tags/tag_family.h"
#include "observations/place_in_rig.h"

namespace apriltrack {
namespace {

constexpr double kMostCoordinate_px = 1e6;  // no camera has such pixels: a damaged file
constexpr double kMinEdge_px = 4.0;         // below it a corner's error is as large as the edge's slope
constexpr double kMaxRepeatedShare = 0.05;  // more frames with two copies: two objects, not a stray detection
constexpr std::size_t kFewFrames = 4;
constexpr double kSamePlaceShare = 0.5;  // of an edge: two detections of one tag lie closer than this

Eigen::Vector2d center_px(const CornersPx& c) {
  return 0.25 * (c[0] + c[1] + c[2] + c[3]);
}

/// Convex, and turning the way a tag does that is seen from its front (y down: bottom-left to bottom-right to
/// top-right is a left turn, the cross product is negative).
bool is_seen_from_front(const CornersPx& corners) {
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d a = corners[(i + 1) % 4] - corners[i];
    const Eigen::Vector2d b = corners[(i + 2) % 4] - corners[(i + 1) % 4];
    constexpr double kMinSineOfCorner = 0.02;
    if (!(a.x() * b.y() - a.y() * b.x() <= -kMinSineOfCorner * a.norm() * b.norm())) return false;
  }
  return true;
}

bool is_usable(const CornersPx& corners, const CameraModel& model) {
  return is_quad_of_tag(corners) && std::ranges::all_of(corners, [&](const Eigen::Vector2d& pixel) {
           return model.unproject(pixel).has_value();
         });
}

/// The usable detections of one image; of detections of one tag at one place the surest.
std::map<TagKey, std::vector<const Detection*>> usable_by_tag(const FrameDetections& frame,
                                                              const CameraModel& model,
                                                              std::size_t& unusable) {
  std::map<TagKey, std::vector<const Detection*>> by_tag;
  for (const Detection& detection : frame.detections) {
    if (!is_usable(detection.corners_px, model)) {
      ++unusable;
      continue;
    }
    std::vector<const Detection*>& places = by_tag[detection.tag];
    const auto same = std::find_if(places.begin(), places.end(), [&](const Detection* other) {
      return (center_px(other->corners_px) - center_px(detection.corners_px)).norm() <
             kSamePlaceShare * mean_edge_px(detection.corners_px);
    });
    if (same == places.end()) {
      places.push_back(&detection);
    } else if (detection.decision_margin.value_or(0.0) > (*same)->decision_margin.value_or(0.0)) {
      *same = &detection;
    }
  }
  return by_tag;
}

/// Everything about one image that later steps need, before tags get their numbers.
struct UsableFrame {
  Timestamp timestamp;
  int camera = 0;
  std::map<TagKey, std::vector<const Detection*>> detections;
};

std::vector<RigCamera> rig_cameras(const CameraRig& rig, const std::set<std::string>& used) {
  for (const std::string& name : used) rig.find(name);
  std::vector<RigCamera> cameras;
  for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
    const bool is_one_of_several = used.size() > 1 && used.contains(rig.cameras[i].name);
    cameras.push_back(
        {rig.cameras[i].model, place_in_rig(rig, i, is_one_of_several), 0.0, rig.cameras[i].name});
  }
  return cameras;
}

int camera_index(const CameraRig& rig, const std::string& name) {
  for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
    if (rig.cameras[i].name == name) return static_cast<int>(i);
  }
  rig.find(name);  // throws, and lists the names there are
  return -1;
}

std::vector<UsableFrame> usable_frames(std::span<const FrameDetections> frames, const CameraRig& rig,
                                       std::size_t& unusable) {
  std::vector<UsableFrame> result;
  for (const FrameDetections& frame : frames) {
    const int camera = camera_index(rig, frame.camera);
    const CameraModel& model = rig.cameras[static_cast<std::size_t>(camera)].model;
    result.push_back({frame.timestamp, camera, usable_by_tag(frame, model, unusable)});
  }
  std::stable_sort(result.begin(), result.end(), [](const UsableFrame& a, const UsableFrame& b) {
    return std::tie(a.timestamp, a.camera) < std::tie(b.timestamp, b.camera);
  });
  return result;
}

/// Two images of one camera with one time are of two recordings whose clocks start anew. Taken as one film
/// they would alternate, as if the camera leapt to and fro, and of several cameras equal times say which
/// images show one pose of the rig. How to tell the recordings apart only the caller knows.
void require_distinct_times(const std::vector<UsableFrame>& frames, const CameraRig& rig) {
  const auto repeated = std::ranges::adjacent_find(frames, [](const UsableFrame& a, const UsableFrame& b) {
    return a.timestamp == b.timestamp && a.camera == b.camera;
  });
  if (repeated == frames.end()) return;
  throw invalid_input(
      "calibrate",
      fmt::format("{} has two images of the time {} ns: a camera may have one image of a time, as times tell "
                  "what follows what, and which images of several cameras belong together; shift the time "
                  "stamps of further recordings behind those of the first",
                  rig.cameras[static_cast<std::size_t>(repeated->camera)].name, repeated->timestamp.ns));
}

std::map<TagKey, RepeatedTag> count_repetitions(const std::vector<UsableFrame>& frames) {
  std::map<TagKey, RepeatedTag> repetitions;
  for (const UsableFrame& frame : frames) {
    for (const auto& [tag, places] : frame.detections) {
      RepeatedTag& repetition = repetitions[tag];
      repetition.tag = tag;
      ++repetition.frames;
      if (places.size() > 1) ++repetition.frames_with_copies;
      repetition.most_copies = std::max(repetition.most_copies, places.size());
    }
  }
  return repetitions;
}

/// Corners need no decoding, but a map does: whoever reads it looks for the printed pattern.
void require_known_tags(const std::map<TagKey, RepeatedTag>& repetitions) {
  for (const auto& [tag, repetition] : repetitions) {
    if (!TagFamily::is_known(tag.family))
      throw invalid_input("calibrate", fmt::format("detections name the family '{}', which no map can hold; "
                                                   "name the printed one: {}",
                                                   tag.family, fmt::join(TagFamily::names(), ", ")));
    const int num_codes = TagFamily::get(tag.family).num_codes();
    if (tag.id >= num_codes)
      throw invalid_input("calibrate", fmt::format("detections name tag {}, but {} has ids 0 to {}",
                                                   to_string(tag), tag.family, num_codes - 1));
  }
}

void require_two_tags(const std::map<TagKey, RepeatedTag>& repetitions) {
  const auto is_many = [](const auto& one) { return one.second.is_many_tags(); };
  const auto first = std::ranges::find_if(repetitions, is_many);
  const auto single =
      repetitions.size() - static_cast<std::size_t>(std::ranges::count_if(repetitions, is_many));
  if (single < 2 && first != repetitions.end()) throw no_result("calibrate", description_of(first->second));
}

Observations number_views(const std::vector<UsableFrame>& frames,
                          const std::map<TagKey, RepeatedTag>& repetitions, const EdgeNoise& noise) {
  Observations observations;
  std::map<TagKey, int> index;
  for (const auto& [tag, repetition] : repetitions) {
    if (repetition.is_many_tags()) continue;
    index[tag] = static_cast<int>(observations.tags.size());
    observations.tags.push_back(tag);
  }
  const UsableFrame* previous = nullptr;
  for (const UsableFrame& frame : frames) {
    const bool shares_pose = previous != nullptr && previous->timestamp == frame.timestamp;
    if (!shares_pose) observations.frames.push_back(frame.timestamp);
    previous = &frame;
    for (const auto& [tag, places] : frame.detections) {
      if (places.size() > 1 || !index.contains(tag)) continue;
      TagView view{index[tag],   static_cast<int>(observations.frames.size()) - 1,
                   frame.camera, places.front()->corners_px,
                   {},           {}};
      view.covariance_px2 = places.front()->covariance_px2;
      view.index = observations.views.size();
      view.set_noise(view.corners_px, noise);
      observations.views.push_back(view);
    }
  }
  return observations;
}

}  // namespace

/// One frame alone may be a stray detection, unless there are hardly any others.
bool RepeatedTag::is_many_tags() const {
  if (frames_with_copies == 0) return false;
  if (frames_with_copies == 1) return frames < kFewFrames;
  return static_cast<double>(frames_with_copies) > kMaxRepeatedShare * static_cast<double>(frames);
}

std::string description_of(const RepeatedTag& tag) {
  return fmt::format(
      "{} is not one tag: up to {} copies of it are seen at once (copies in {} of {} frames). A map needs an "
      "id of its own for every tag: print tags with different ids, or cover the copies",
      to_string(tag.tag), tag.most_copies, tag.frames_with_copies, tag.frames);
}

void TagView::set_noise(const CornersPx& edges, const EdgeNoise& noise) {
  inward = inward_displacements(edges);
  const Matrix8d of_model = edge_noise_whitening(edges, noise);
  whitening = of_model;
  by_model_errors.setIdentity();
  if (!covariance_px2) return;
  claimed_px2 =
      noise.sigma_px * noise.sigma_px * (of_model * *covariance_px2 * of_model.transpose()).trace() / 8.0;
  whitening = corner_whitening(edges, *covariance_px2, noise);
  by_model_errors = whitening * of_model.inverse();
}

Observations collect_observations(std::span<const FrameDetections> frames, const CameraRig& rig,
                                  const TagSizes& sizes, const CalibrationOptions& options,
                                  UnusedDetections& unused) {
  std::set<std::string> used;
  std::size_t detections = 0;
  for (const FrameDetections& frame : frames) {
    if (!frame.detections.empty()) used.insert(frame.camera);
    detections += frame.detections.size();
  }
  if (detections == 0)
    throw no_result("calibrate",
                    fmt::format("no tags were seen in {} frames; check the tag family, and that tags are "
                                "sharp and at least 20 pixels wide",
                                frames.size()));
  std::size_t unusable = 0;
  const std::vector<UsableFrame> usable = usable_frames(frames, rig, unusable);
  if (unusable == detections)
    throw no_result(
        "calibrate",
        fmt::format(
            "none of the {} detections shows a tag as this camera can see one: check the camera file and "
            "the corner order (bottom-left, bottom-right, top-right, top-left)",
            detections));
  require_distinct_times(usable, rig);
  const std::map<TagKey, RepeatedTag> repetitions = count_repetitions(usable);
  require_known_tags(repetitions);
  require_two_tags(repetitions);
  unused = {detections, unusable, {}};
  for (const auto& [tag, repetition] : repetitions)
    if (repetition.frames_with_copies > 0) unused.repeated.push_back(repetition);
  Observations observations =
      number_views(usable, repetitions, {options.corner_sigma_px, options.edge_end_correlation});
  if (options.corner_bias_px > 0.0)
    for (TagView& view : observations.views)
      if (view.covariance_px2)
        view.kept_share = std::sqrt(view.covariance_px2->trace() / 8.0) / options.corner_bias_px;
  observations.cameras = rig_cameras(rig, used);
  for (const TagKey& tag : observations.tags) observations.sizes_m.push_back(sizes.find(tag).value_or(0.0));
  return observations;
}

bool is_quad_of_tag(const CornersPx& corners) {
  for (std::size_t i = 0; i < 4; ++i) {
    if (!(corners[i].cwiseAbs().maxCoeff() <= kMostCoordinate_px) || !corners[i].allFinite()) return false;
    if ((corners[(i + 1) % 4] - corners[i]).norm() < kMinEdge_px) return false;
  }
  return is_seen_from_front(corners);
}

double mean_edge_px(const CornersPx& corners) {
  double sum = 0.0;
  for (std::size_t i = 0; i < 4; ++i) sum += (corners[(i + 1) % 4] - corners[i]).norm();
  return 0.25 * sum;
}

std::string list_tags(std::span<const TagKey> keys, std::size_t limit) {
  std::string text;
  for (std::size_t i = 0; i < std::min(limit, keys.size()); ++i)
    text += (i > 0 ? ", " : "") + to_string(keys[i]);
  if (keys.size() > limit) text += fmt::format(" and {} more", keys.size() - limit);
  return text;
}

TagKey key_of(const Observations& observations, int tag) {
  return observations.tags[static_cast<std::size_t>(tag)];
}

std::vector<TagKey> keys_of(const Observations& observations, const std::vector<int>& tags) {
  std::vector<TagKey> keys;
  for (const int tag : tags) keys.push_back(key_of(observations, tag));
  return keys;
}

}  // namespace apriltrack
