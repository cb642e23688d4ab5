#include "apriltrack/tracker/paper_tracker.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "apriltrack/base/held.h"
#include "frame_steps.h"
#include "image_size.h"
#include "paper_references.h"

namespace apriltrack {
namespace {

/// A motion model without evidence is believed so long, and no longer.
constexpr std::int64_t kMaxPrediction_ns = 500'000'000;

Image<float> grey_levels(const GrayView& image) {
  Image<float> grey(image.width(), image.height());
  for (int y = 0; y < image.height(); ++y) std::copy_n(image.row(y), image.width(), grey.row(y));
  return grey;
}

}  // namespace

class PaperTracker::Implementation {
 public:
  Implementation(const Camera& camera, const TagMap& map, const PaperTrackerOptions& options)
      : camera_(camera),
        map_(map),
        options_((options.check(), options)),
        localizer_(camera, map, options.localizer),
        likelihood_(camera, map, options.localizer.mode, options.likelihood),
        references_(camera_.model, map_, options.likelihood.grid, likelihood_),
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
    references_.renew(picture.light[0].view(), detections);
    const std::optional<PaperEvidence> evidence = weigh(picture);
    TrackResult result = answer(evidence, localized);
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
    time_ = time;
    const FrameSteps::Step step = steps_.advance(time);
    if (step.is_anew) forget();
    for (std::size_t i = 0; is_started_ && i < step.count; ++i) filter_.advance();
  }

  /// Another recording, of which nothing is known but the camera's pace.
  void forget() {
    is_started_ = false;
    evidence_time_.reset();
    references_.forget();
  }

  /// Gives every particle its weight; what the best one shows, if there are any.
  std::optional<PaperEvidence> weigh(const PhotometricFrame& picture) {
    if (!is_started_) return std::nullopt;
    hypotheses_.resize(filter_.particles().size());
    for (std::size_t i = 0; i < hypotheses_.size(); ++i) hypotheses_[i].pose = filter_.particles()[i].pose();
    likelihood_.evaluate(picture, hypotheses_, parallel_, &scores_);
    filter_.weigh(scores_.log_likelihoods);
    return references_.weigh(scores_, filter_.best(), options_.min_correlation);
  }

  /// The best particle where it looks like its tags, else the detections' pose, from which the cloud starts
  /// again, else what the motion predicts.
  TrackResult answer(const std::optional<PaperEvidence>& evidence, const TrackResult& localized) {
    if (evidence && evidence->mean_correlation >= options_.min_correlation) return report_best(*evidence);
    if (localized.pose) return restart(localized);
    return report_prediction();
  }

  TrackResult report_best(const PaperEvidence& evidence) {
    const std::size_t best = filter_.best();
    TrackResult result;
    result.status = evidence.has_detected ? TrackStatus::kDetected : TrackStatus::kTracked;
    result.pose = filter_.particles()[best].pose();
    result.covariance = filter_.second_moment(*result.pose);
    result.tags_tracked = evidence.num_agreeing;
    evidence_time_ = time_;
    references_.discard(scores_, best, options_.discard_correlation);
    return result;
  }

  TrackResult restart(const TrackResult& localized) {
    filter_.start(*localized.pose);
    is_started_ = true;
    evidence_time_ = time_;
    return localized;
  }

  TrackResult report_prediction() {
    TrackResult result;
    if (is_started_ && time_.ns - evidence_time_->ns <= kMaxPrediction_ns) {
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
  PaperReferences references_;
  PaperFilter filter_;
  ParallelFor parallel_;
  std::optional<Detector> detector_;
  bool is_started_ = false;
  FrameSteps steps_;
  Timestamp time_;                          ///< Of this frame.
  std::optional<Timestamp> evidence_time_;  ///< Of the last frame whose tags agreed with the answer.
  std::vector<MotionState> hypotheses_;
  JointScores scores_;
};

PaperTracker::PaperTracker(const Camera& camera, const TagMap& map, const PaperTrackerOptions& options)
    : implementation_(std::make_unique<Implementation>(camera, map, options)) {}
PaperTracker::~PaperTracker() = default;
PaperTracker::PaperTracker(PaperTracker&&) noexcept = default;
PaperTracker& PaperTracker::operator=(PaperTracker&&) noexcept = default;

void PaperTracker::prepare() {
  held(implementation_).prepare();
}
TrackResult PaperTracker::track(const Frame& frame) {
  return held(implementation_).track(frame);
}
TrackResult PaperTracker::track(const Frame& frame, const std::vector<Detection>& detections) {
  return held(implementation_).track(frame, detections);
}
const DetectorOptions& PaperTracker::detector_options() const {
  return held(implementation_).detector_options();
}
const PaperFilter& PaperTracker::filter() const {
  return held(implementation_).filter();
}
std::span<const double> PaperTracker::reference_patch(std::size_t index) const {
  return held(implementation_).reference_patch(index);
}

}  // namespace apriltrack
