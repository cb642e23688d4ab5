#include "apriltrack/tracker/paper_tracker.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "apriltrack/base/error.h"
#include "apriltrack/geometry/homography.h"
#include "frame_pace.h"
#include "image_size.h"
#include "tag_observation.h"

namespace apriltrack {
namespace {

/// A motion model without evidence is believed so long, and no longer.
constexpr std::int64_t kMaxPrediction_ns = 500'000'000;
/// Of a tag's patch: less of it in the image is not evidence.
constexpr double kMinSeenShare = 0.25;
constexpr std::size_t kMaxFramesAtOnce = 15;

Image<float> grey_levels(const GrayView& image) {
  Image<float> grey(image.width(), image.height());
  for (int y = 0; y < image.height(); ++y) std::copy_n(image.row(y), image.width(), grey.row(y));
  return grey;
}

/// (u, v, 1) of the tag's plane, in half tag sizes, to rays, from the four detected corners alone (the
/// paper's reference homography); nullopt when they do not determine it.
std::optional<Eigen::Matrix3d> rays_from_plane(const CameraModel& model, const TagObservation& observation) {
  std::array<Eigen::Vector2d, kNumCorners> plane, rays;
  const auto corners_tag = tag_corners(2.0);
  for (std::size_t i = 0; i < plane.size(); ++i) {
    const auto ray = model.unproject(observation.corners_px[i]);
    if (!ray || !(ray->z() > 0.0)) return std::nullopt;
    plane[i] = corners_tag[i].head<2>();
    rays[i] = ray->head<2>() / ray->z();
  }
  return estimate_homography(plane, rays);
}

/// The scores of one hypothesis, tag by tag, with what they say together.
struct Evidence {
  double mean_correlation = 0.0;  ///< Each tag weighed by what is seen of it.
  int num_agreeing = 0;
  bool has_detected = false;  ///< A tag detected in this frame agrees.
};

}  // namespace

std::string_view to_string(PaperVariant variant) {
  return variant == PaperVariant::kPrinted ? "printed" : "program";
}

PaperTrackerOptions PaperTrackerOptions::published(PaperVariant variant) {
  PaperTrackerOptions options;
  options.likelihood.tag_template = TagTemplate::kReference;
  options.likelihood.grid.half_extent = 0.1936 / 0.1635;  // tau of a 0.1635 m tag: some margin in
  options.likelihood.gamma = 10.0;
  if (variant == PaperVariant::kPrinted) {
    options.likelihood.grid.size = 32;
    options.likelihood.error = PatchError::kLinear;
    options.filter.num_particles = 3000;
    options.filter.noise = {
        .position_m = 0.01, .rotation_rad = 0.05, .velocity_m = 0.02, .angular_velocity_rad = 0.0};
  } else {
    options.likelihood.grid.size = 64;
    options.likelihood.error = PatchError::kMinusLog;
    options.likelihood.average_over_tags = true;
    options.filter.num_particles = 6000;
    options.filter.noise = {
        .position_m = 0.005, .rotation_rad = 0.03, .velocity_m = 0.01, .angular_velocity_rad = 0.03};
    options.filter.moves_with_new_velocity = true;
    options.discard_correlation = 0.33;  // exp(-1.1)
  }
  return options;
}

void PaperTrackerOptions::check() const {
  localizer.check();
  filter.check();
  likelihood.check();
  if (likelihood.tag_template != TagTemplate::kReference)
    throw invalid_input("tag_template", "must be kReference: the paper compares with earlier views");
  if (!(discard_correlation >= -1.0 && discard_correlation < 1.0)) {
    throw invalid_input("discard_correlation",
                        fmt::format("must lie in [-1, 1) (is {})", discard_correlation));
  }
  if (!(min_correlation > 0.0 && min_correlation < 1.0))
    throw invalid_input("min_correlation", fmt::format("must lie in (0, 1) (is {})", min_correlation));
  if (num_threads < 0 || num_threads > 1024)
    throw invalid_input("num_threads", fmt::format("must lie in [0, 1024] (is {})", num_threads));
}

class PaperTracker::Implementation {
 public:
  Implementation(const Camera& camera, const TagMap& map, const PaperTrackerOptions& options)
      : camera_(camera),
        map_(map),
        options_((options.check(), options)),
        localizer_(camera, map, options.localizer),
        likelihood_(camera, map, options.localizer.mode, options.likelihood),
        filter_(options.filter),
        parallel_(parallel_for(options.num_threads)) {}

  TrackResult track(const Frame& frame) {
    if (const auto lost = lost_to_another_camera(frame, camera_)) return *lost;
    prepare();
    const auto start = std::chrono::steady_clock::now();
    return track(frame, detector_->detect(frame.image), start);
  }

  TrackResult track(const Frame& frame, const std::vector<Detection>& detections,
                    std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now()) {
    if (const auto lost = lost_to_another_camera(frame, camera_)) return *lost;
    PhotometricFrame picture;
    picture.light.push_back(grey_levels(frame.image));
    const FrameDetections seen{frame.timestamp, camera_.name, detections};
    const TrackResult localized = localizer_.localize(seen, frame.exposure_s);
    advance(frame.timestamp);
    renew_references(picture, detections);
    TrackResult result = weigh(picture, localized);
    result.timestamp = frame.timestamp;
    result.tags_detected = localized.tags_detected;
    result.latency_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return result;
  }

  void prepare() {
    if (!detector_) detector_.emplace(localizer_.detector_options());
  }

  const DetectorOptions& detector_options() const { return localizer_.detector_options(); }
  const PaperFilter& filter() const { return filter_; }
  std::span<const double> reference_patch(std::size_t index) const { return likelihood_.reference(index); }

 private:
  /// The paper counts frames, not time: frames that are missing are steps all the same.
  void advance(Timestamp time) {
    std::size_t steps = 1;
    if (time_ && time.ns < time_->ns) {
      forget();
    } else if (time_) {
      steps = steps_in(time.ns - time_->ns);
    }
    time_ = time;
    for (std::size_t i = 0; is_started_ && i < steps; ++i) filter_.advance();
  }

  /// Time runs backwards: another recording, of which nothing is known but the camera's pace.
  void forget() {
    is_started_ = false;
    evidence_time_.reset();
    excess_frames_ = 0.0;
    for (std::size_t i = 0; i < map_.tags.size(); ++i) likelihood_.clear_reference(i);
  }

  /// Frames in the time since the last, at least this one. What a frame with a false time stamp came too
  /// early is missing from its interval and too much in the next: it is not counted twice.
  std::size_t steps_in(std::int64_t interval_ns) {
    if (interval_ns == 0) return 1;  // tells no pace
    pace_.add(interval_ns);
    const double frames = static_cast<double>(interval_ns) / static_cast<double>(pace_.frame_interval_ns());
    const double steps =
        std::clamp(std::round(frames - excess_frames_), 1.0, static_cast<double>(kMaxFramesAtOnce));
    excess_frames_ = std::max(0.0, steps - frames);
    return static_cast<std::size_t>(steps);
  }

  /// The patch of every tag seen is its reference from now on, this frame included. A tag that the frame
  /// shows twice is left out: any copy may be the false one.
  void renew_references(const PhotometricFrame& picture, const std::vector<Detection>& detections) {
    is_detected_.assign(map_.tags.size(), false);
    std::vector<double> patch(options_.likelihood.grid.num_samples());
    for (const TagObservation& observation : observe_mapped_tags(map_, camera_.model, detections)) {
      const auto index = static_cast<std::size_t>(observation.tag - map_.tags.data());
      const auto H = rays_from_plane(camera_.model, observation);
      if (observation.is_repeated || !H) continue;
      const int num_seen =
          sample_patch(picture.light[0].view(), camera_.model, *H, options_.likelihood.grid, patch);
      if (num_seen < PatchMatch::kMinSamples) continue;
      likelihood_.set_reference(index, patch);
      is_detected_[index] = true;
    }
  }

  TrackResult weigh(const PhotometricFrame& picture, const TrackResult& localized) {
    std::optional<Evidence> evidence;
    if (is_started_) {
      hypotheses_.resize(filter_.particles().size());
      for (std::size_t i = 0; i < hypotheses_.size(); ++i)
        hypotheses_[i].pose = filter_.particles()[i].pose();
      likelihood_.evaluate(picture, hypotheses_, parallel_, &scores_);
      filter_.weigh(scores_.log_likelihoods);
      evidence = weigh_evidence(filter_.best());
    }
    const bool is_evident = evidence && evidence->mean_correlation >= options_.min_correlation;
    if (!is_evident && localized.pose) return restart(localized);
    if (is_evident) return report_best(*evidence);
    return report_prediction();
  }

  Evidence weigh_evidence(std::size_t particle) const {
    Evidence evidence;
    double sum = 0.0, total_share = 0.0;
    for (std::size_t k = 0; k < scores_.num_tags; ++k) {
      const TagScore& score = scores_.tag(particle, k);
      if (score.seen_share < kMinSeenShare) continue;
      sum += score.seen_share * score.correlation;
      total_share += score.seen_share;
      const bool agrees = score.correlation >= options_.min_correlation;
      evidence.num_agreeing += agrees ? 1 : 0;
      evidence.has_detected = evidence.has_detected || (agrees && is_detected_[k]);
    }
    if (total_share > 0.0) evidence.mean_correlation = sum / total_share;
    return evidence;
  }

  TrackResult report_best(const Evidence& evidence) {
    const std::size_t best = filter_.best();
    TrackResult result;
    result.status = evidence.has_detected ? TrackStatus::kDetected : TrackStatus::kTracked;
    result.pose = filter_.particles()[best].pose();
    result.covariance = filter_.second_moment(*result.pose);
    result.tags_tracked = evidence.num_agreeing;
    evidence_time_ = time_;
    discard_references(best);
    return result;
  }

  void discard_references(std::size_t particle) {
    for (std::size_t k = 0; k < scores_.num_tags; ++k) {
      const TagScore& score = scores_.tag(particle, k);
      const bool is_judged = score.seen_share >= kMinSeenShare;
      if (is_judged && score.correlation < options_.discard_correlation) likelihood_.clear_reference(k);
    }
  }

  TrackResult restart(const TrackResult& localized) {
    filter_.start(*localized.pose);
    is_started_ = true;
    evidence_time_ = time_;
    return localized;
  }

  TrackResult report_prediction() {
    TrackResult result;
    if (is_started_ && time_->ns - evidence_time_->ns <= kMaxPrediction_ns) {
      result.status = TrackStatus::kPredicted;
      result.pose = filter_.mean();
      result.covariance = filter_.second_moment(*result.pose);
      return result;
    }
    result.reason = is_started_ || evidence_time_ ? "the tags were lost, and none has been detected since"
                                                  : "no tag of the map detected so far";
    is_started_ = false;
    return result;
  }

  Camera camera_;
  TagMap map_;
  PaperTrackerOptions options_;
  Localizer localizer_;
  JointLikelihood likelihood_;
  PaperFilter filter_;
  ParallelFor parallel_;
  std::optional<Detector> detector_;
  bool is_started_ = false;
  std::optional<Timestamp> time_;           ///< Of the last frame.
  std::optional<Timestamp> evidence_time_;  ///< Of the last frame whose tags agreed with the answer.
  FramePace pace_;
  double excess_frames_ = 0.0;     ///< Steps taken at the last frame beyond the time it took.
  std::vector<bool> is_detected_;  ///< In this frame, by tag of the map.
  std::vector<MotionState> hypotheses_;
  JointScores scores_;
};

PaperTracker::PaperTracker(const Camera& camera, const TagMap& map, const PaperTrackerOptions& options)
    : implementation_(std::make_unique<Implementation>(camera, map, options)) {}
PaperTracker::~PaperTracker() = default;
PaperTracker::PaperTracker(PaperTracker&&) noexcept = default;
PaperTracker& PaperTracker::operator=(PaperTracker&&) noexcept = default;

void PaperTracker::prepare() {
  implementation_->prepare();
}
TrackResult PaperTracker::track(const Frame& frame) {
  return implementation_->track(frame);
}
TrackResult PaperTracker::track(const Frame& frame, const std::vector<Detection>& detections) {
  return implementation_->track(frame, detections);
}
const DetectorOptions& PaperTracker::detector_options() const {
  return implementation_->detector_options();
}
const PaperFilter& PaperTracker::filter() const {
  return implementation_->filter();
}
std::span<const double> PaperTracker::reference_patch(std::size_t index) const {
  return implementation_->reference_patch(index);
}

}  // namespace apriltrack
