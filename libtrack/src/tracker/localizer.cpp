#include "apriltrack/tracker/localizer.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <utility>

#include "apriltrack/base/held.h"
#include "chance_readings.h"
#include "corner_noise.h"
#include "frame_warning.h"
#include "image_size.h"
#include "known_exposure.h"
#include "map_detection.h"
#include "map_uncertainty.h"
#include "pose_adjustment.h"
#include "pose_candidate.h"
#include "pose_memory.h"

namespace apriltrack {
namespace {

constexpr double kUnknownExposure_s = 0.01;     // indoor webcams: 5 to 30 ms
constexpr double kMinOdds = 1e-3;               // what is less likely than this is ruled out
constexpr double kMinLogPriorOfSupport = -5.0;  // 3 sigma from the prediction

struct Choice {
  PoseCandidate candidate;
  std::optional<Matrix6d> cov_T_camera_map;  ///< nullopt where the corners do not determine the pose.
  std::optional<PoseMemory::Mode> second;    ///< T_camera_map, and its odds.
};

TrackResult lost(std::string reason) {
  TrackResult result;
  result.reason = std::move(reason);
  return result;
}

std::optional<PoseMemory::Mode> second_mode(const TrackResult& result) {
  if (!result.second_pose) return std::nullopt;
  return PoseMemory::Mode{*result.second_pose, result.second_mode_odds};
}

using Inliers = std::vector<const TagObservation*>;

bool contains(const Inliers& inliers, const TagObservation& seen) {
  return std::ranges::count(inliers, &seen) > 0;
}

}  // namespace

class Localizer::Implementation {
 public:
  Implementation(const Camera& camera, const TagMap& map, const LocalizerOptions& options)
      : camera_(camera),
        map_(map),
        index_(map),
        reading_odds_(map),
        options_(options),
        detector_options_((options.check(), detector_options_for(camera, map, options.detector))) {}

  TrackResult localize(const Frame& frame) {
    if (const auto lost = lost_to_another_camera(frame, camera_)) return *lost;
    prepare();  // the tables are no part of a frame's latency
    const auto start = std::chrono::steady_clock::now();
    const std::vector<Detection> detections = detector_->detect(frame.image);
    return localize(frame.timestamp, detections, frame.exposure_s, start);
  }

  TrackResult localize(const FrameDetections& frame, std::optional<double> exposure_s) {
    return localize(frame.timestamp, frame.detections, exposure_s, std::chrono::steady_clock::now());
  }

  void prepare() {
    if (!detector_) detector_.emplace(detector_options_);
  }

  const DetectorOptions& detector_options() const { return detector_options_; }

 private:
  TrackResult localize(Timestamp time, const std::vector<Detection>& detections,
                       std::optional<double> exposure_of_frame_s,
                       std::chrono::steady_clock::time_point start) {
    const auto observations =
        observe_mapped_tags(map_, index_, camera_.model, detections, options_.corner_sigma_px);
    const double exposure_s =
        known_exposure_s(exposure_of_frame_s, camera_.exposure_s).value_or(kUnknownExposure_s);
    TrackResult result = observations.empty()
                             ? lost(detections.empty() ? "no tag seen" : "no tag of the map seen")
                             : of_observations(time, observations, exposure_s);
    result.timestamp = time;
    result.warning = exposure_warning(exposure_of_frame_s, camera_.exposure_s);
    result.tags_detected = count_tags(observations);
    result.latency_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return result;
  }

  /// Its pose, or why there is none, and what goes with these. observations: not empty.
  TrackResult of_observations(Timestamp time, const std::vector<TagObservation>& observations,
                              double exposure_s) {
    std::vector<PoseCandidate> candidates = supported_candidates(time, observations);
    if (candidates.empty()) {
      return lost(count_tags(observations) > 1 ? "the tags seen do not agree on a pose"
                                               : "the corners seen fit no pose");
    }
    std::erase_if(candidates, [&](const PoseCandidate& c) { return is_read_by_chance(c); });
    if (candidates.empty())
      return lost("a tag of so few bits that chance may read it, and none beside that agrees");
    const Choice choice = choose(time, observations, candidates, exposure_s);
    if (!choice.cov_T_camera_map) return lost("the corners seen do not determine the pose");
    TrackResult result = found(choice);
    result.contradicting_tags = left_aside(observations, choice.candidate.inliers);
    memory_.remember(time, *result.pose, second_mode(result));
    return result;
  }

  /// Tags read beyond doubt that are not among the inliers.
  std::vector<TagKey> left_aside(const std::vector<TagObservation>& observations,
                                 const Inliers& inliers) const {
    std::vector<TagKey> keys;
    for (const TagObservation& seen : observations) {
      const bool is_sure =
          seen.corrected_bits == 0 && !seen.is_repeated && !reading_odds_.may_be_chance(seen);
      if (is_sure && !contains(inliers, seen)) keys.push_back(seen.tag->key);
    }
    return keys;
  }

  /// Those that have enough behind them.
  std::vector<PoseCandidate> supported_candidates(Timestamp time,
                                                  const std::vector<TagObservation>& observations) const {
    std::vector<Pose> predictions;
    for (const PoseMemory::Mode& mode : memory_.predict(time))
      predictions.push_back(T_camera_map_of(mode.pose));
    const CandidateOptions options{options_.max_residual_rms_px};
    std::vector<PoseCandidate> candidates =
        find_pose_candidates(camera_.model, observations, predictions, options);
    std::erase_if(candidates, [&](const PoseCandidate& c) { return !is_supported(time, observations, c); });
    return candidates;
  }

  /// Whether it rests on one tag alone, of a family with so few bits that a quad of something else is read as
  /// a mapped one now and then.
  bool is_read_by_chance(const PoseCandidate& candidate) const {
    return candidate.inliers.size() == 1 && reading_odds_.may_be_chance(*candidate.inliers.front());
  }

  /// The candidate that corners and recent poses together make most likely. candidates: not empty.
  Choice choose(Timestamp time, const std::vector<TagObservation>& observations,
                const std::vector<PoseCandidate>& candidates, double exposure_s) const {
    // One scale of noise for all, or a bad fit would excuse itself.
    const auto best_fit =
        std::min_element(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) {
          return std::pair(-a.num_corners(), a.squared_error) < std::pair(-b.num_corners(), b.squared_error);
        });
    const double noise_scale =
        fitted_noise_scale(options_.corner_sigma_px, expected_scale(time, *best_fit, exposure_s), *best_fit);
    std::vector<double> cost;
    for (const PoseCandidate& candidate : candidates) {
      cost.push_back(misfit(camera_.model, observations, noise_scale, candidate.T_camera_map) -
                     memory_.log_prior(time, reported(candidate.T_camera_map)));
    }
    const auto best = static_cast<std::size_t>(std::min_element(cost.begin(), cost.end()) - cost.begin());
    Choice choice{candidates[best], covariance(time, candidates[best], exposure_s), std::nullopt};
    for (std::size_t i = 0; choice.cov_T_camera_map && i < candidates.size(); ++i) {
      const double odds = std::exp(cost[best] - cost[i]);
      if (i == best || odds < kMinOdds || (choice.second && odds <= choice.second->weight)) continue;
      if (is_same_explanation(choice.candidate.T_camera_map, *choice.cov_T_camera_map,
                              candidates[i].T_camera_map))
        continue;
      choice.second = PoseMemory::Mode{candidates[i].T_camera_map, odds};
    }
    return choice;
  }

  /// Most of the tags seen agree, or half of them do and the motion so far speaks for these: it settles a
  /// tie, but a minority would carry a pose that began in the map of another place from frame to frame. A tag
  /// that the frame shows twice speaks for nothing by itself: any of its copies may be the false one.
  bool is_supported(Timestamp time, const std::vector<TagObservation>& observations,
                    const PoseCandidate& candidate) const {
    const std::size_t num_seen = num_voters(observations, candidate.inliers);
    const bool has_unrepeated = std::any_of(candidate.inliers.begin(), candidate.inliers.end(),
                                            [](const TagObservation* o) { return !o->is_repeated; });
    const bool has_several = candidate.inliers.size() > 1;
    const bool is_majority = 2 * candidate.inliers.size() > num_seen;
    if (is_majority && (has_unrepeated || has_several)) return true;
    const bool is_half = 2 * candidate.inliers.size() >= num_seen;
    return is_half && !memory_.predict(time).empty() &&
           memory_.log_prior(time, reported(candidate.T_camera_map)) > kMinLogPriorOfSupport;
  }

  /// Tags that agree with the inliers or speak against them. What chance may have read speaks against nothing
  /// that a tag read for sure speaks for; among its like, it does.
  std::size_t num_voters(const std::vector<TagObservation>& observations, const Inliers& inliers) const {
    const auto may_be_chance = [&](const TagObservation* o) { return reading_odds_.may_be_chance(*o); };
    const bool is_sure = !std::ranges::all_of(inliers, may_be_chance);
    Inliers voters;
    for (const TagObservation& seen : observations) {
      if (!is_sure || contains(inliers, seen) || !may_be_chance(&seen)) voters.push_back(&seen);
    }
    return static_cast<std::size_t>(count_tags(voters));
  }

  double expected_scale(Timestamp time, const PoseCandidate& candidate, double exposure_s) const {
    std::optional<double> blur_px;
    if (exposure_s == 0.0) {
      blur_px = 0.0;
    } else if (const auto last = memory_.last(time)) {
      blur_px =
          corner_blur_px(camera_.model, candidate, T_camera_map_of(last->pose), last->age_s, exposure_s);
    }
    return expected_noise_scale(options_.corner_sigma_px, blur_px, candidate);
  }

  /// Its covariance is known.
  TrackResult found(const Choice& choice) const {
    const Pose& T_camera_map = choice.candidate.T_camera_map;
    TrackResult result;
    result.status = TrackStatus::kDetected;
    result.pose = reported(T_camera_map);
    const Matrix6d moved = pose_covariance_from_camera(T_camera_map, *choice.cov_T_camera_map, options_.mode);
    result.covariance = 0.5 * (moved + moved.transpose());
    result.tags_tracked = count_tags(choice.candidate.inliers);
    if (choice.second) {
      result.second_pose = reported(choice.second->pose);
      result.second_mode_odds = choice.second->weight;
    }
    return result;
  }

  /// Of T_camera_map, by the noise of the corners, the covariances of the map's tags and the motion; nullopt
  /// where the corners do not determine it.
  std::optional<Matrix6d> covariance(Timestamp time, const PoseCandidate& candidate,
                                     double exposure_s) const {
    const std::vector<const TagObservation*>& inliers = candidate.inliers;
    const Pose& T_camera_map = candidate.T_camera_map;
    const Eigen::LLT<Matrix6d> information(corner_information(camera_.model, inliers, T_camera_map));
    const Matrix6d inverse_information = information.solve(Matrix6d::Identity());
    const MapUncertainty map = map_uncertainty(camera_.model, inliers, T_camera_map, inverse_information);
    const double scale = fitted_noise_scale(
        options_.corner_sigma_px, expected_scale(time, candidate, exposure_s), candidate, map.squared_error);
    Matrix6d covariance = scale * scale * inverse_information + map.covariance;
    if (const auto last = memory_.last(time)) {
      const Pose predicted = memory_.predict(time).front().pose;
      covariance += uneven_motion_covariance(T_camera_map, T_camera_map_of(last->pose),
                                             T_camera_map_of(predicted), last->age_s, exposure_s);
    }
    if (information.info() != Eigen::Success || !covariance.allFinite()) return std::nullopt;
    return covariance;
  }

  /// The pose that is reported: T_camera_body, or T_world_camera.
  Pose reported(const Pose& T_camera_map) const { return pose_from_camera(T_camera_map, options_.mode); }
  Pose T_camera_map_of(const Pose& pose) const { return camera_from_map(pose, options_.mode); }

  Camera camera_;
  TagMap map_;
  TagIndex index_;  ///< Of the map's tags.
  ReadingOdds reading_odds_;
  LocalizerOptions options_;
  DetectorOptions detector_options_;
  std::optional<Detector> detector_;  ///< Made by prepare(): detections from a file need none.
  PoseMemory memory_;
};

Localizer::Localizer(const Camera& camera, const TagMap& map, const LocalizerOptions& options)
    : implementation_(std::make_unique<Implementation>(camera, map, options)) {}
Localizer::~Localizer() = default;
Localizer::Localizer(Localizer&&) noexcept = default;
Localizer& Localizer::operator=(Localizer&&) noexcept = default;

void Localizer::prepare() {
  held(implementation_).prepare();
}

TrackResult Localizer::localize(const Frame& frame) {
  return held(implementation_).localize(frame);
}
TrackResult Localizer::localize(const FrameDetections& detections, std::optional<double> exposure_s) {
  return held(implementation_).localize(detections, exposure_s);
}

const DetectorOptions& Localizer::detector_options() const {
  return held(implementation_).detector_options();
}

}  // namespace apriltrack
