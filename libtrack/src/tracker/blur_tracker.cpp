#include "apriltrack/tracker/blur_tracker.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apriltrack/base/held.h"
#include "blur_explanation.h"
#include "frame_warning.h"
#include "image_size.h"
#include "known_exposure.h"
#include "lost_reason.h"
#include "map_detection.h"
#include "overruled_motion.h"
#include "recording.h"
#include "rivals.h"
#include "tag_reader.h"

namespace apriltrack {
namespace {

using Clock = std::chrono::steady_clock;

BlurTrackerOptions checked(const BlurTrackerOptions& options) {
  options.check();
  return options;
}

/// Coarsely seen, it is of one brightness, to a tenth of what the darkest films that are tracked show of a
/// tag.
bool is_blank(const LightPyramid& light) {
  constexpr float kLeastRange = 5e-4F;
  const Image<float>& coarse = light.back();
  float darkest = std::numeric_limits<float>::infinity(), brightest = -darkest;
  for (int y = 0; y < coarse.height(); ++y) {
    for (int x = 0; x < coarse.width(); ++x) {
      darkest = std::min(darkest, coarse(x, y));
      brightest = std::max(brightest, coarse(x, y));
    }
  }
  return brightest - darkest < kLeastRange;
}

bool are_same(const std::vector<Detection>& a, const std::vector<Detection>& b) {
  return std::ranges::equal(a, b, [](const Detection& one, const Detection& other) {
    return one.tag == other.tag && one.corners_px == other.corners_px;
  });
}

TagMap checked(const TagMap& map) {
  check_tag_map(map);
  return map;
}

}  // namespace

class BlurTracker::Implementation {
 public:
  Implementation(const Camera& camera, const TagMap& map, const BlurTrackerOptions& options)
      : options_(checked(options)),
        camera_(camera),
        map_(checked(map)),
        // The tags' ids are checked now; without a size in the camera file, rays wait for the first image.
        world_(camera_, map_, options_.mode, camera_.width, camera_.height),
        reader_(detector_options_for(camera_, map_, options_.detector), map_, world_,
                options_.corner_sigma_px),
        explainer_(world_, options_) {
    start_anew();
  }

  void prepare() { reader_.prepare(); }
  const DetectorOptions& detector_options() const { return reader_.options(); }

  TrackResult track(const Frame& frame) {
    if (!lost_to_another_camera(frame, camera_)) prepare();  // the tables are no part of a frame's latency
    return track(frame, nullptr);
  }

  /// detections: null where they are this tracker's own task.
  TrackResult track(const Frame& frame, const std::vector<Detection>* detections) {
    const Clock::time_point start = Clock::now();
    const std::optional<Timestamp> before = recording_->last_time;
    TrackResult result = tracked(frame, detections);
    result.warning = warning_of(frame, before);
    result.latency_s = std::chrono::duration<double>(Clock::now() - start).count();
    return result;
  }

 private:
  TrackResult tracked(const Frame& frame, const std::vector<Detection>* detections) {
    if (const auto lost = lost_to_another_camera(frame, camera_)) {  // nor is its time stamp believed
      recording_->judge.missed();
      return *lost;
    }
    if (const auto lost = lost_to_its_time(frame.timestamp)) return *lost;
    fit_size(frame.image);
    const FrameExposure exposure = exposure_of(frame);
    BlurFrame blur_frame = prepared(frame, exposure);
    if ((detections == nullptr || detections->empty()) && is_blank(blur_frame.photometric.light))
      return blank(blur_frame, exposure);
    const std::vector<MotionHypothesis> expected = predict(exposure, blur_frame);
    look_for_tags(frame, detections, expected, blur_frame);
    const std::vector<Explanation> found = explain_by_tags_that_agree(frame, expected, blur_frame);
    TrackResult result = report(found, expected, exposure, blur_frame);
    result.timestamp = frame.timestamp;
    result.exposure = exposure.report();
    result.tags_detected = count_tags(blur_frame.read);
    light_ = std::move(blur_frame.photometric.light);
    result.detections = std::move(blur_frame.detections);
    result.left_out = std::move(blur_frame.left_out);
    result.detection_s = blur_frame.detection_s;
    return result;
  }

  std::string warning_of(const Frame& frame, const std::optional<Timestamp>& before) const {
    const bool is_anew = before && *recording_->last_time < *before;
    return joined_warnings(is_anew ? new_recording_warning(*before, frame.timestamp) : "",
                           exposure_warning(frame.exposure_s, camera_.exposure_s));
  }

  void start_anew() { recording_.emplace(options_, map_, world_, reader_); }

  /// A frame that is much earlier than the one before is of another recording; where it is a little earlier,
  /// or of the same time, its stamp is wrong, or it was delivered twice.
  std::optional<TrackResult> lost_to_its_time(Timestamp time) {
    constexpr double kMaxStepBack_s = 0.1;
    const std::optional<Timestamp>& last = recording_->last_time;
    if (last && time.ns <= last->ns) {
      if (seconds_between(time, *last) <= kMaxStepBack_s) {
        TrackResult lost;
        lost.timestamp = time;
        lost.reason = "the time stamp is not later than that of the frame before";
        return lost;
      }
      start_anew();
    }
    recording_->last_time = time;
    return std::nullopt;
  }

  /// Where the camera's file tells no resolution, its first image does.
  void fit_size(const GrayView& image) {
    if (camera_.width > 0 && camera_.height > 0) return;
    camera_.width = image.width();
    camera_.height = image.height();
    world_.fit_size(image.width(), image.height());
  }

  FrameExposure exposure_of(const Frame& frame) {
    return recording_->exposures.next(frame.timestamp,
                                      known_exposure_s(frame.exposure_s, camera_.exposure_s));
  }

  BlurFrame prepared(const Frame& frame, const FrameExposure& exposure) {
    BlurFrame result;
    result.time = frame.timestamp;
    result.photometric.light = std::move(light_);  // its memory
    fill_light_pyramid(frame.image, camera_.response, PhotometricWorld::kNumLevels, result.photometric.light);
    result.photometric.exposure_s = exposure.exposure_s;
    result.index = recording_->num_frames++;
    result.interval_s = recording_->motion.age_s(frame.timestamp);
    if (exposure.base_s > 0.0 && frame.gain > 0.0) result.sensitivity = exposure.base_s * frame.gain;
    return result;
  }

  /// From the motion so far, and the turn that the scene shows since.
  std::vector<MotionHypothesis> predict(const FrameExposure& exposure, BlurFrame& frame) {
    const MotionMemory& motion = recording_->motion;
    std::optional<SeenTurn> turn;
    if (recording_->turns)
      turn = recording_->turns->turn(frame.time, frame.photometric.light, motion, world_);
    frame.step_s = turn ? motion.step_s(frame.time) : frame.interval_s;
    std::vector<MotionHypothesis> expected = motion.predict(frame.time, exposure.sigma, turn);
    if (expected.empty()) recording_->judge.missed();
    return expected;
  }

  /// Where the motion went on as expected, no farther than is needed.
  void look_for_tags(const Frame& frame, const std::vector<Detection>* detections,
                     const std::vector<MotionHypothesis>& expected, BlurFrame& blur_frame) {
    if (detections != nullptr) {
      reader_.take(*detections, blur_frame);
      blur_frame.is_searched = true;
    } else if (expected.empty() || !recording_->judge.is_confirmed()) {
      recording_->search.look_everywhere(frame, blur_frame);
    } else {
      recording_->search.look(frame, expected.front().belief, blur_frame);
    }
  }

  bool is_convincing(const std::vector<Explanation>& found, const BlurFrame& frame) const {
    return !found.empty() && !is_overruled(found) &&
           recording_->judge.is_convincing(found.front(), frame.interval_s);
  }

  /// Best first; without tags that do not fit the others.
  std::vector<Explanation> explain_by_tags_that_agree(const Frame& frame,
                                                      const std::vector<MotionHypothesis>& expected,
                                                      BlurFrame& blur_frame) {
    TagConsensus& consensus = recording_->consensus;
    consensus.begin_frame();
    consensus.were_read(blur_frame);
    std::vector<Explanation> found;
    do {
      found = explain(frame, expected, blur_frame);
    } while (is_convincing(found, blur_frame) && consensus.leaves_one_out(blur_frame, found.front()));
    recording_->search.were_read(blur_frame);
    return found;
  }

  /// Where nothing else convinces, the whole frame is searched, and then the tags that were hidden are looked
  /// for as well.
  std::vector<Explanation> explain(const Frame& frame, const std::vector<MotionHypothesis>& expected,
                                   BlurFrame& blur_frame) {
    TagConsensus& consensus = recording_->consensus;
    consensus.choose(blur_frame, false);
    std::vector<Explanation> found = explainer_.explain(blur_frame, expected);
    if (!blur_frame.is_searched && !(is_convincing(found, blur_frame) && found.front().is_explained())) {
      const std::vector<Detection> before = blur_frame.detections;
      recording_->search.look_everywhere(frame, blur_frame);
      consensus.were_read(blur_frame);
      consensus.choose(blur_frame, false);
      if (!are_same(before, blur_frame.detections)) found = explainer_.explain(blur_frame, expected);
    }
    if (!consensus.knows_hidden_tags() || is_convincing(found, blur_frame)) return found;
    consensus.choose(blur_frame, true);
    std::vector<Explanation> with_hidden = explainer_.explain(blur_frame, expected);
    return is_convincing(with_hidden, blur_frame) ? with_hidden : found;
  }

  TrackResult report(const std::vector<Explanation>& found, const std::vector<MotionHypothesis>& expected,
                     const FrameExposure& exposure, const BlurFrame& frame) {
    const std::string reason = objection(found, expected, frame);
    if (!reason.empty()) return go_on_without(found, expected, frame, reason);
    if (recording_->consensus.is_doubtful(found.front())) return follow(found, frame);
    return claim(found, exposure, frame);
  }

  /// Why nothing may be claimed; empty where something may.
  std::string objection(const std::vector<Explanation>& found, const std::vector<MotionHypothesis>& expected,
                        const BlurFrame& frame) {
    if (!is_convincing(found, frame)) return lost_reason(frame, found);
    return recording_->consensus.objection(frame, found.front(), expected);
  }

  /// Reports what is found, and remembers it.
  TrackResult claim(const std::vector<Explanation>& found, const FrameExposure& exposure,
                    const BlurFrame& frame) {
    const Explanation& best = found.front();
    const MotionBelief belief = belief_of(world_, best);
    TrackResult result = recording_->report.found(found, belief);
    result.tags_tracked = recording_->judge.num_supporting(best);
    recording_->consensus.report(frame, best, result);

    recording_->judge.claimed(best);
    recording_->consensus.learn(frame, best, has_rival(world_, found));
    const double slower = recording_->exposures.claimed(frame.time, exposure, world_, best.fit);
    recording_->motion.remember(frame.time, motions_left_open(world_, belief, found), slower);
    return result;
  }

  /// Goes on from what is good enough for that, and claims nothing.
  TrackResult follow(const std::vector<Explanation>& found, const BlurFrame& frame) {
    const MotionBelief belief = belief_of(world_, found.front());
    TrackResult result = recording_->report.found(found, belief);
    result.status = TrackStatus::kPredicted;
    recording_->judge.missed();
    recording_->motion.remember(frame.time, motions_left_open(world_, belief, found));
    return result;
  }

  /// A frame that shows nothing, not even that nothing can be seen of the tags: a closed shutter, a dropout.
  TrackResult blank(BlurFrame& frame, const FrameExposure& exposure) {
    recording_->judge.missed();
    TrackResult result =
        recording_->report.expected(recording_->motion.predict(frame.time, exposure.sigma, {}));
    result.timestamp = frame.time;
    result.exposure = exposure.report();
    if (!result.pose) result.reason = "the image is of one brightness, and no recent pose to predict from";
    light_ = std::move(frame.photometric.light);
    return result;
  }

  /// Reports what is expected, and goes on from there.
  TrackResult go_on_without(const std::vector<Explanation>& found,
                            const std::vector<MotionHypothesis>& expected, const BlurFrame& frame,
                            const std::string& reason) {
    TrackResult result = recording_->report.expected(expected);
    if (!result.pose) result.reason = reason;

    recording_->judge.missed();
    if (!found.empty() && !is_overruled(found)) recording_->consensus.learn_contradictions(found.front());
    if (options_.mode == TrackMode::kEgo && !expected.empty()) recording_->motion.step(frame.time, expected);
    return result;
  }

  BlurTrackerOptions options_;
  Camera camera_;
  TagMap map_;
  PhotometricWorld world_;
  TagReader reader_;
  BlurExplainer explainer_;
  std::optional<Recording> recording_;
  LightPyramid light_;  ///< Of the last frame, between frames.
};

BlurTracker::BlurTracker(const Camera& camera, const TagMap& map, const BlurTrackerOptions& options)
    : implementation_(std::make_unique<Implementation>(camera, map, options)) {}
BlurTracker::~BlurTracker() = default;
BlurTracker::BlurTracker(BlurTracker&&) noexcept = default;
BlurTracker& BlurTracker::operator=(BlurTracker&&) noexcept = default;

void BlurTracker::prepare() {
  held(implementation_).prepare();
}
TrackResult BlurTracker::track(const Frame& frame) {
  return held(implementation_).track(frame);
}
TrackResult BlurTracker::track(const Frame& frame, const std::vector<Detection>& detections) {
  return held(implementation_).track(frame, &detections);
}
const DetectorOptions& BlurTracker::detector_options() const {
  return held(implementation_).detector_options();
}

}  // namespace apriltrack
