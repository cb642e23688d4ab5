#include "apriltrack/tracker/blur_tracker.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <chrono>
#include <cmath>

#include "apriltrack/base/error.h"
#include "blur_corners.h"
#include "blur_covariance.h"
#include "blur_explanation.h"
#include "contrast_memory.h"
#include "image_size.h"
#include "known_exposure.h"
#include "map_detection.h"

namespace apriltrack {
namespace {

// Right states reach 0.943 and more where a tag is read, 0.957 where none is, in photoreal recordings; half a
// tag behind a hand costs some of that.
constexpr double kMinCorrelation = 0.85;
constexpr double kMinCorrelationWithDetection = 0.5;
// Found again without a detection: a wide search also finds what merely looks like a blurred tag. It reached
// 0.95, and 11 standard deviations of the motion, before a wall of patches; right states reached 7.5 of them.
constexpr double kMinCorrelationAgain = 0.95;
constexpr double kMaxPriorCostAgain = 0.5 * 9.0 * 9.0;
// Of what a claim without a detection rests on: a sliver of a border fits nearly any edge.
constexpr double kMinSamples = 40.0;
constexpr double kLeastOdds = 1e-3;  // what is less likely than this is ruled out

}  // namespace

void BlurTrackerOptions::check() const {
  if (!(corner_sigma_px > 0.0 && std::isfinite(corner_sigma_px)))
    throw invalid_input("corner_sigma_px", fmt::format("must be > 0 (is {})", corner_sigma_px));
  if (num_particles < 16 || num_particles > 1'000'000)
    throw invalid_input("num_particles", fmt::format("must be 16 to 1000000 (is {})", num_particles));
  for (const double density : {motion_noise.linear_m2_per_s3, motion_noise.angular_rad2_per_s3}) {
    if (!(density > 0.0 && std::isfinite(density)))
      throw invalid_input("motion_noise", fmt::format("must be > 0 (is {})", density));
  }
  if (!(max_prediction_s >= 0.0 && max_prediction_s <= 0.5))
    throw invalid_input("max_prediction_s", fmt::format("must be 0 to 0.5 (is {})", max_prediction_s));
  if (!(default_exposure_s >= 0.0 && default_exposure_s <= 1.0))
    throw invalid_input("default_exposure_s", fmt::format("must be 0 to 1 (is {})", default_exposure_s));
  detector.check();
}

class BlurTracker::Implementation {
 public:
  Implementation(const Camera& camera, const TagMap& map, const BlurTrackerOptions& options)
      : camera_(camera), map_(map), options_(options) {
    options.check();
    detector_options_ = detector_options_for(camera, map, options.detector);
    // The tags' ids are checked now; without a size in the camera file, rays wait for the first image.
    world_.emplace(camera_, map_, options_.mode, camera_.width, camera_.height);
    explainer_.emplace(*world_, options_);
  }

  void prepare() {
    if (!detector_) detector_.emplace(detector_options_);
  }

  TrackResult track(const Frame& frame) {
    if (const auto lost = lost_to_another_camera(frame, camera_)) return *lost;
    prepare();  // the tables are no part of a frame's latency
    const auto start = std::chrono::steady_clock::now();
    return track(frame, detector_->detect(frame.image), start);
  }

  TrackResult track(const Frame& frame, const std::vector<Detection>& detections,
                    std::chrono::steady_clock::time_point start) {
    if (const auto lost = lost_to_another_camera(frame, camera_)) return *lost;
    fit_size(frame.image);
    TrackResult result;
    result.timestamp = frame.timestamp;
    const std::optional<MotionBelief> belief = predicted(frame.timestamp);
    if (!belief) forget();
    const BlurFrame blur_frame = prepared(frame, detections);
    result.tags_detected = count_tags(blur_frame.observations);

    const std::vector<Explanation> found = explainer_->explain(blur_frame, belief);
    const TagVotes votes = found.empty() ? TagVotes() : votes_for(blur_frame, found.front());
    const bool has_evidence = !found.empty() && is_convincing(found.front(), votes);
    if (has_evidence) {
      result.status = votes.agreeing > 0 ? TrackStatus::kDetected : TrackStatus::kTracked;
      report_evidence(found, votes, result);
    } else if (belief) {
      result.status = TrackStatus::kPredicted;
      result.pose = belief->mean.pose;
      result.covariance = belief->covariance.topLeftCorner<6, 6>() + map_covariance_;
    } else {
      result.reason = why_lost(detections, blur_frame, result.tags_detected, !found.empty());
    }
    is_confirmed_ = has_evidence && (is_confirmed_ || votes.agreeing > 0);
    result.latency_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return result;
  }

  const DetectorOptions& detector_options() const { return detector_options_; }

 private:
  /// Where the camera's file tells no resolution, its first image does.
  void fit_size(const GrayView& image) {
    if (camera_.width > 0 && camera_.height > 0) return;
    camera_.width = image.width();
    camera_.height = image.height();
    world_->fit_size(image.width(), image.height());
  }

  BlurFrame prepared(const Frame& frame, const std::vector<Detection>& detections) {
    BlurFrame result;
    result.photometric.light =
        light_pyramid(to_linear_light(frame.image, camera_.response), PhotometricWorld::kNumLevels);
    result.photometric.exposure_s =
        known_exposure_s(frame.exposure_s, camera_.exposure_s).value_or(options_.default_exposure_s);
    result.observations = observe_mapped_tags(map_, camera_.model, detections);
    result.index = num_frames_++;
    if (belief_) result.interval_s = seconds_between(evidence_time_, frame.timestamp);
    return result;
  }

  /// The belief at `time`; none when the last evidence is too old, or time does not run forward.
  std::optional<MotionBelief> predicted(Timestamp time) const {
    if (!belief_) return std::nullopt;
    const double age_s = seconds_between(evidence_time_, time);
    if (!(age_s > 0.0 && age_s <= options_.max_prediction_s)) return std::nullopt;
    return predict(*belief_, options_.motion_noise, age_s);
  }

  static std::string why_lost(const std::vector<Detection>& detections, const BlurFrame& frame,
                              int tags_detected, bool has_fit) {
    if (detections.empty()) return "no tag seen, and no recent pose to look from";
    if (frame.observations.empty()) return "no tag of the map seen, and no recent pose to look from";
    if (tags_detected > 1) return "the tags seen do not agree on a pose";
    if (has_fit) return "a pose fits the corners, but not the pixels around them: exposure, or response?";
    return "the corners seen fit no pose";
  }

  /// A frame that is too late, or not later, starts anew. What is known of the tags' contrast stays: a
  /// detection renews it.
  void forget() {
    belief_.reset();
    is_confirmed_ = false;
  }

  /// Enough of what should be seen is seen, and more tags speak for the state than against it: in the map of
  /// another place single tags fit, and only the others can tell.
  bool is_convincing(const Explanation& best, const TagVotes& votes) const {
    const std::vector<TagEvidence> tags = trusted_tags(best, votes);
    if (std::max(num_explained(tags), votes.agreeing) <= votes.contradicting) return false;
    if (votes.agreeing > 0) return typical_correlation(tags) >= kMinCorrelationWithDetection;
    if (samples_of_explained(tags) < kMinSamples) return false;
    if (is_confirmed_) return typical_correlation(tags) >= kMinCorrelation;
    return typical_correlation(tags) >= kMinCorrelationAgain && best.prior_cost <= kMaxPriorCostAgain;
  }

  /// Without a detection that agrees, tags of another contrast than they had count as not explained.
  std::vector<TagEvidence> trusted_tags(const Explanation& explanation, const TagVotes& votes) const {
    std::vector<TagEvidence> tags = explanation.fit.tags;
    if (votes.agreeing == 0) contrasts_.doubt(tags);
    return tags;
  }

  static int num_explained(const std::vector<TagEvidence>& tags) {
    return static_cast<int>(std::ranges::count_if(tags, is_explained));
  }

  static bool is_explained(const TagEvidence& tag) { return tag.correlation >= kMinCorrelation; }

  static double samples_of_explained(const std::vector<TagEvidence>& tags) {
    double sum = 0.0;
    for (const TagEvidence& tag : tags) sum += is_explained(tag) ? tag.independent_samples() : 0.0;
    return sum;
  }

  TagVotes votes_for(const BlurFrame& frame, const Explanation& explanation) const {
    return count_votes(*world_, frame.observations, explanation.fit.state, frame.photometric.exposure_s,
                       options_.corner_sigma_px);
  }

  void report_evidence(const std::vector<Explanation>& found, const TagVotes& votes, TrackResult& result) {
    const Explanation& best = found.front();
    const std::vector<TagEvidence> tags = trusted_tags(best, votes);
    MotionBelief belief{best.fit.state, fit_covariance(*world_, best.fit)};
    belief.mean.acceleration.setZero();
    result.pose = belief.mean.pose;
    map_covariance_ = map_covariance(*world_, best.fit);
    result.covariance = belief.covariance.topLeftCorner<6, 6>() + map_covariance_;
    result.tags_tracked = std::max(num_explained(tags), votes.agreeing);
    for (const Explanation& other : found) {
      const double odds = std::exp(other.score - best.score);
      if (odds < kLeastOdds || result.second_pose || !is_distinct(belief, other.fit.state.pose)) continue;
      result.second_pose = other.fit.state.pose;
      result.second_mode_odds = odds;
    }
    contrasts_.remember(tags);
    belief_ = belief;
    evidence_time_ = result.timestamp;
  }

  /// Beyond five standard deviations.
  static bool is_distinct(const MotionBelief& belief, const Pose& pose) {
    const Vector6d off = (belief.mean.pose.inverse() * pose).log();
    return off.dot(Matrix6d(belief.covariance.topLeftCorner<6, 6>()).ldlt().solve(off)) > 25.0;
  }

  Camera camera_;
  TagMap map_;
  BlurTrackerOptions options_;
  DetectorOptions detector_options_;
  std::optional<Detector> detector_;  ///< Made by prepare(): detections from a file need none.
  std::optional<PhotometricWorld> world_;
  std::optional<BlurExplainer> explainer_;
  std::optional<MotionBelief> belief_;          ///< At evidence_time_.
  Matrix6d map_covariance_ = Matrix6d::Zero();  ///< What the map adds to it.
  Timestamp evidence_time_;
  ContrastMemory contrasts_;
  bool is_confirmed_ = false;  ///< Evidence in every frame since one with a detection that agrees.
  std::uint64_t num_frames_ = 0;
};

BlurTracker::BlurTracker(const Camera& camera, const TagMap& map, const BlurTrackerOptions& options)
    : implementation_(std::make_unique<Implementation>(camera, map, options)) {}
BlurTracker::~BlurTracker() = default;
BlurTracker::BlurTracker(BlurTracker&&) noexcept = default;
BlurTracker& BlurTracker::operator=(BlurTracker&&) noexcept = default;

void BlurTracker::prepare() {
  implementation_->prepare();
}
TrackResult BlurTracker::track(const Frame& frame) {
  return implementation_->track(frame);
}
TrackResult BlurTracker::track(const Frame& frame, const FrameDetections& detections) {
  return implementation_->track(frame, detections.detections, std::chrono::steady_clock::now());
}
const DetectorOptions& BlurTracker::detector_options() const {
  return implementation_->detector_options();
}

}  // namespace apriltrack
