#include "apriltrack/tracker/blur_tracker.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "blur_covariance.h"
#include "blur_explanation.h"
#include "blur_judge.h"
#include "frame_exposures.h"
#include "image_size.h"
#include "known_exposure.h"
#include "map_detection.h"
#include "motion_memory.h"
#include "resting_pose.h"
#include "tag_consensus.h"
#include "tag_regions.h"

namespace apriltrack {
namespace {

constexpr double kLeastOdds = 1e-3;  // what is less likely than this is ruled out
// The same before the next frame was seen: that one may tell by hundreds of nats. Two explanations that look
// alike differ by what the model leaves out (how the motion changes within the exposure, the lens), which
// errs alike in all pixels: their difference counts a quarter. At a turn of room_blur the right one of path
// and reverse scored 10 less; the other explained nothing of the next frame.
constexpr double kLeastScoreCarried = -40.0;
constexpr double kTrustInScores = 0.25;
constexpr double kDistinctSigmas = 5.0;
/// A rival: of a score as good but for so much, it puts a tag elsewhere by more than a path's reverse does.
constexpr double kLeastScoreOfRival = -7.0;
constexpr double kElsewhere_px = 10.0;
/// How often the whole image is glanced at for tags that nothing expects, and how coarsely.
constexpr double kGlanceInterval_s = 1.0;
constexpr double kGlanceDecimate = 2.0;

}  // namespace

class BlurTracker::Implementation {
 public:
  Implementation(const Camera& camera, const TagMap& map, const BlurTrackerOptions& options)
      : camera_(camera),
        map_(map),
        options_(options),
        motion_(options.motion_noise, options.max_prediction_s),
        gyroscope_(camera.model),
        exposures_(options.motion_noise, options.default_exposure_s) {
    options.check();
    detector_options_ = detector_options_for(camera, map, options.detector);
    // The tags' ids are checked now; without a size in the camera file, rays wait for the first image.
    world_.emplace(camera_, map_, options_.mode, camera_.width, camera_.height);
    explainer_.emplace(*world_, options_);
    consensus_.emplace(*world_, options_);
  }

  void prepare() {
    if (!detector_) detector_.emplace(detector_options_);
  }

  TrackResult track(const Frame& frame) {
    if (lost_to_another_camera(frame, camera_))
      return track(frame, nullptr, std::chrono::steady_clock::now());
    prepare();  // the tables are no part of a frame's latency
    return track(frame, nullptr, std::chrono::steady_clock::now());
  }

  /// detections: null where they are this tracker's own task.
  TrackResult track(const Frame& frame, const std::vector<Detection>* detections,
                    std::chrono::steady_clock::time_point start) {
    start_anew_if_time_runs_back(frame.timestamp);
    if (const auto lost = lost_to_another_camera(frame, camera_)) {
      judge_.missed();
      return *lost;
    }
    fit_size(frame.image);
    detection_s_ = 0.0;
    TrackResult result;
    result.timestamp = frame.timestamp;
    exposure_ = exposures_.next(frame.timestamp, known_exposure_s(frame.exposure_s, camera_.exposure_s));
    result.exposure = exposure_.report();
    BlurFrame blur_frame = prepared(frame);
    const std::vector<MotionHypothesis> expected =
        motion_.predict(frame.timestamp, exposure_.sigma, seen_turn(frame.timestamp, blur_frame));
    blur_frame.step_s = is_turn_seen_ ? motion_.step_s(frame.timestamp) : blur_frame.interval_s;
    if (expected.empty()) judge_.missed();
    if (detections != nullptr) {
      see(*detections, blur_frame);
      blur_frame.is_searched = true;
    } else {
      look(frame, expected, blur_frame);
    }
    const std::vector<Explanation> found = consistent_explanations(frame, blur_frame, expected);
    result.tags_detected = count_tags(blur_frame.read);
    regions_.were_read(blur_frame.read);
    if (is_convincing(found, blur_frame) && consensus_->allows(blur_frame, found.front(), expected)) {
      report_evidence(found, result);
      consensus_->report(blur_frame, found.front(), result);
      consensus_->learn(blur_frame, found.front(), has_rival(found));
      if (consensus_->is_doubtful(found.front())) result.status = TrackStatus::kPredicted;
    } else {
      if (!found.empty()) consensus_->learn_contradictions(found.front());
      judge_.missed();
      at_rest_.forget();
      report_prediction(expected, result);
      if (options_.mode == TrackMode::kEgo && !expected.empty()) motion_.step(frame.timestamp, expected);
      if (!result.pose) result.reason = why_lost(blur_frame, found);
    }
    result.detections = std::move(blur_frame.detections);
    result.detection_s = detection_s_;
    result.latency_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return result;
  }

  const DetectorOptions& detector_options() const { return detector_options_; }

 private:
  /// A frame that is not later than the one before is of another recording.
  void start_anew_if_time_runs_back(Timestamp time) {
    if (last_time_ && time.ns <= last_time_->ns) {
      motion_.forget();
      judge_ = BlurJudge();
      consensus_->forget();
      exposures_.forget();
      gyroscope_.forget();
      at_rest_.forget();
      regions_ = {};
      last_search_ = {};
      num_frames_ = 0;
      map_covariance_.setZero();
    }
    last_time_ = time;
  }

  /// Where the camera's file tells no resolution, its first image does.
  void fit_size(const GrayView& image) {
    if (camera_.width > 0 && camera_.height > 0) return;
    camera_.width = image.width();
    camera_.height = image.height();
    world_->fit_size(image.width(), image.height());
  }

  BlurFrame prepared(const Frame& frame) {
    BlurFrame result;
    result.photometric.light =
        light_pyramid(to_linear_light(frame.image, camera_.response), PhotometricWorld::kNumLevels);
    result.photometric.exposure_s = exposure_.exposure_s;
    result.index = num_frames_++;
    result.interval_s = motion_.age_s(frame.timestamp);
    if (exposure_.base_s > 0.0 && frame.gain > 0.0) result.sensitivity = exposure_.base_s * frame.gain;
    return result;
  }

  /// Of a camera among things at rest; what a body before a camera does is not seen in the scene.
  std::optional<SeenTurn> seen_turn(Timestamp time, const BlurFrame& frame) {
    is_turn_seen_ = false;
    const Timestamp before = std::exchange(turn_time_, time);
    if (options_.mode != TrackMode::kEgo || !options_.is_scene_at_rest) return std::nullopt;
    const std::optional<CameraTurn> turn = gyroscope_.turn(frame.photometric.light);
    // A turn of the last frame alone is none of a longer step.
    const MotionState* last = motion_.at(before);
    if (!turn || last == nullptr) return std::nullopt;
    const std::vector<std::size_t> tags = world_->tags_in_sight(*last);
    if (tags.empty()) return std::nullopt;
    const Pose view = camera_from_map(last->pose, options_.mode);
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const std::size_t k : tags)
      middle += view * world_->tags[k].tag.T_map_tag.translation() / static_cast<double>(tags.size());
    constexpr double kLeastDistance_m = 0.1;  // nearer, any way would look like a large turn
    is_turn_seen_ = middle.norm() >= kLeastDistance_m;
    if (!is_turn_seen_) return std::nullopt;
    return SeenTurn{*turn, middle};
  }

  void see(std::vector<Detection> detections, BlurFrame& blur_frame) const {
    blur_frame.detections = std::move(detections);
    blur_frame.read = observe_mapped_tags(map_, world_->index, camera_.model, blur_frame.detections);
  }

  /// As far as is needed: where the motion went on as expected, at the places of tags; at times at the whole
  /// image in half its resolution, for tags that nothing expects; else everywhere.
  void look(const Frame& frame, const std::vector<MotionHypothesis>& expected, BlurFrame& blur_frame) {
    if (expected.empty() || !judge_.is_confirmed()) return search(frame, blur_frame);
    const GrayView& image = frame.image;
    if (seconds_between(last_search_, frame.timestamp) >= kGlanceInterval_s) {
      last_search_ = frame.timestamp;
      const std::array whole = {ImageRegion{0, 0, image.width(), image.height()}};
      return see(timed([&] { return detector_->detect_in(image, whole, kGlanceDecimate); }), blur_frame);
    }
    const std::vector<ImageRegion> regions = regions_.choose(
        *world_, expected.front().belief, blur_frame.photometric.exposure_s, image.width(), image.height());
    see(timed([&] { return detector_->detect_in(image, regions); }), blur_frame);
  }

  /// What `detect` finds; its time is counted.
  template <class Detect>
  std::vector<Detection> timed(const Detect& detect) {
    const auto start = std::chrono::steady_clock::now();
    std::vector<Detection> found = detect();
    detection_s_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return found;
  }

  void search(const Frame& frame, BlurFrame& blur_frame) {
    last_search_ = frame.timestamp;
    see(timed([&] { return detector_->detect(frame.image); }), blur_frame);
    blur_frame.is_searched = true;
  }

  bool is_convincing(const std::vector<Explanation>& found, const BlurFrame& frame) const {
    return !found.empty() && judge_.is_convincing(found.front(), frame.interval_s);
  }

  /// Where nothing else convinces, the whole frame is searched, and then the tags that were hidden are looked
  /// for as well.
  std::vector<Explanation> explanations(const Frame& frame, BlurFrame& blur_frame,
                                        const std::vector<MotionHypothesis>& expected) {
    consensus_->choose(blur_frame, false);
    std::vector<Explanation> found = explainer_->explain(blur_frame, expected);
    if (!blur_frame.is_searched && !(is_convincing(found, blur_frame) && found.front().is_explained())) {
      search(frame, blur_frame);
      consensus_->choose(blur_frame, false);
      found = explainer_->explain(blur_frame, expected);
    }
    if (!consensus_->knows_hidden_tags() || is_convincing(found, blur_frame)) return found;
    consensus_->choose(blur_frame, true);
    std::vector<Explanation> with_hidden = explainer_->explain(blur_frame, expected);
    return is_convincing(with_hidden, blur_frame) ? with_hidden : found;
  }

  /// Without what does not fit the other tags.
  std::vector<Explanation> consistent_explanations(const Frame& frame, BlurFrame& blur_frame,
                                                   const std::vector<MotionHypothesis>& expected) {
    consensus_->begin_frame();
    std::vector<Explanation> found;
    do {
      found = explanations(frame, blur_frame, expected);
    } while (is_convincing(found, blur_frame) && consensus_->leaves_one_out(blur_frame, found.front()));
    return found;
  }

  static std::string why_lost(const BlurFrame& frame, const std::vector<Explanation>& found) {
    if (frame.detections.empty()) return "no tag seen, and no recent pose to look from";
    if (frame.observations.empty() && count_tags(frame.read) == 1)
      return "the tag seen is not where the map has it, as others showed";
    if (frame.observations.empty() && !frame.read.empty()) return "the tags seen do not agree on a pose";
    if (frame.observations.empty()) return "no tag of the map seen, and no recent pose to look from";
    if (found.empty()) return "the corners seen fit no pose";
    const TagVotes& votes = found.front().votes;
    if (votes.agreeing.size() > votes.contradicting.size())
      return "a pose fits the corners, but not the pixels around them: exposure, or response?";
    return count_tags(frame.observations) > 1 ? "the tags seen do not agree on a pose"
                                              : "the corners seen fit no pose";
  }

  void report_evidence(const std::vector<Explanation>& found, TrackResult& result) {
    const Explanation& best = found.front();
    const MotionBelief belief = belief_of(best);
    result.status = best.votes.agreeing.empty() ? TrackStatus::kTracked : TrackStatus::kDetected;
    result.pose = belief.mean.pose;
    result.velocity = belief.mean.velocity;
    map_covariance_ = map_covariance(*world_, best.fit);
    evidence_pose_ = belief.mean.pose;
    result.covariance = belief.covariance.topLeftCorner<6, 6>() + map_covariance_;
    average_at_rest(best.fit, result);
    result.tags_tracked = judge_.num_supporting(best);
    const auto second = std::ranges::find_if(found, [&](const Explanation& other) {
      return distance(belief, other.fit.state.pose) > kDistinctSigmas;
    });
    if (second != found.end())
      report_second_pose(second->fit.state.pose, kTrustInScores * std::min(0.0, second->score - best.score),
                         result);
    judge_.claimed(best);
    const double slower = exposures_.claimed(result.timestamp, exposure_, *world_, best.fit);
    motion_.remember(result.timestamp, motions(belief, found), slower);
  }

  /// The motion found, and the likeliest other one where the next frame may decide for it.
  std::vector<MotionHypothesis> motions(const MotionBelief& belief,
                                        const std::vector<Explanation>& found) const {
    std::vector<MotionHypothesis> result = {{belief, 0.0}};
    for (const Explanation& other : found) {
      const double less = std::min(0.0, other.score - found.front().score);
      if (less < kLeastScoreCarried || result.size() > 1) break;
      if (distance(belief, other.fit.state) > kDistinctSigmas)
        result.push_back({belief_of(other), kTrustInScores * less});
    }
    return result;
  }

  MotionBelief belief_of(const Explanation& explanation) const {
    MotionBelief belief{explanation.fit.state, fit_covariance(*world_, explanation.fit)};
    belief.covariance.topLeftCorner<6, 6>() += explanation.bend_covariance;
    belief.mean.acceleration.setZero();
    return belief;
  }

  void report_prediction(const std::vector<MotionHypothesis>& expected, TrackResult& result) const {
    if (expected.empty()) return;
    const MotionBelief& belief = expected.front().belief;
    result.status = TrackStatus::kPredicted;
    result.pose = belief.mean.pose;
    result.velocity = belief.mean.velocity;
    result.covariance = belief.covariance.topLeftCorner<6, 6>() + map_covariance_at(belief.mean.pose);
    if (expected.size() > 1) report_second_pose(expected[1].belief.mean.pose, expected[1].log_odds, result);
  }

  /// A wrong map is wrong in the same way at the next pose: of the camera in the map's frame, of a body in
  /// its own.
  Matrix6d map_covariance_at(const Pose& pose) const {
    if (options_.mode == TrackMode::kJoint) return map_covariance_;
    const Matrix6d adjoint = (pose.inverse() * evidence_pose_).adjoint();
    return adjoint * map_covariance_ * adjoint.transpose();
  }

  /// Where nothing moves, frames are averaged.
  void average_at_rest(const MotionFit& fit, TrackResult& result) {
    const Matrix12d noise = fit.information.ldlt().solve(Matrix12d::Identity());
    if (const auto mean = at_rest_.add(fit.state.pose, noise.topLeftCorner<6, 6>())) result.pose = *mean;
  }

  /// Whether another place explains the frame about as well.
  bool has_rival(const std::vector<Explanation>& found) const {
    const Explanation& best = found.front();
    return std::ranges::any_of(found, [&](const Explanation& other) {
      return other.score - best.score > kLeastScoreOfRival &&
             std::ranges::any_of(best.fit.tags, [&](const TagEvidence& tag) {
               return !(shift_px(tag, best.fit.state.pose, other.fit.state.pose) <= kElsewhere_px);
             });
    });
  }

  /// Of the tag's centre in the image; infinite where one of the two does not show it.
  double shift_px(const TagEvidence& tag, const Pose& from, const Pose& to) const {
    const Eigen::Vector3d centre =
        world_->tags[static_cast<std::size_t>(tag.tag_index)].tag.T_map_tag.translation();
    const auto before = world_->model.project(camera_from_map(from, options_.mode) * centre);
    const auto after = world_->model.project(camera_from_map(to, options_.mode) * centre);
    return before && after ? (*after - *before).norm() : std::numeric_limits<double>::infinity();
  }

  static void report_second_pose(const Pose& pose, double log_odds, TrackResult& result) {
    if (std::exp(log_odds) < kLeastOdds) return;
    result.second_pose = pose;
    result.second_mode_odds = std::exp(log_odds);
  }

  Camera camera_;
  TagMap map_;
  BlurTrackerOptions options_;
  DetectorOptions detector_options_;
  std::optional<Detector> detector_;  ///< Made by prepare(): detections from a file need none.
  std::optional<PhotometricWorld> world_;
  std::optional<BlurExplainer> explainer_;
  MotionMemory motion_;
  RestingPose at_rest_;
  VisualGyroscope gyroscope_;
  Timestamp turn_time_;        ///< Of the frame that it saw last.
  bool is_turn_seen_ = false;  ///< In this frame.
  FrameExposures exposures_;
  FrameExposure exposure_;  ///< Of this frame.
  BlurJudge judge_;
  std::optional<TagConsensus> consensus_;
  Matrix6d map_covariance_ = Matrix6d::Zero();  ///< What the map adds to that of the last evidence,
  Pose evidence_pose_;                          ///< at that pose.
  TagRegions regions_;
  Timestamp last_search_;     ///< Of the whole image.
  double detection_s_ = 0.0;  ///< In this frame.
  std::optional<Timestamp> last_time_;
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
TrackResult BlurTracker::track(const Frame& frame, const std::vector<Detection>& detections) {
  return implementation_->track(frame, &detections, std::chrono::steady_clock::now());
}
const DetectorOptions& BlurTracker::detector_options() const {
  return implementation_->detector_options();
}

}  // namespace apriltrack
