#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detector.h"
#include "apriltrack/image/frame.h"
#include "apriltrack/motion/motion_state.h"
#include "apriltrack/tags/tag_map.h"
#include "apriltrack/tracker/track_result.h"

namespace apriltrack {

struct BlurTrackerOptions {
  TrackMode mode = TrackMode::kEgo;
  /// Ego: what lies behind the tags does not move, so that the whole scene tells how the camera turns. Not so
  /// in a cockpit, or of tags that are waved before a camera that stands.
  bool is_scene_at_rest = true;
  /// families and response are taken from the map and the camera.
  DetectorOptions detector;
  /// How fast the motion changes, for prediction.
  MotionNoise motion_noise;
  /// Expected corner error per axis, from the detector's own tests: sharp frames, linear light.
  double corner_sigma_px = 0.1;
  /// Where a frame is not explained at once: how many states are tried around the prediction at first.
  int num_particles = 240;
  std::uint64_t seed = 0;
  /// How long a pose is predicted without evidence before it is lost.
  double max_prediction_s = 0.5;
  /// Exposure where neither the frame nor the camera tells one, until the motion does.
  double default_exposure_s = 0.01;

  /// Throws Error(kInvalidInput) that names the option, its value and its range.
  void check() const;
};

/// Tracks through motion blur (`--method blur`): the tags' pictures, blurred along the path that they take
/// during the exposure, are fitted to the pixels of all visible tags together with pose and velocity,
/// detected corners and the motion so far (docs/algorithms/blur_tracker.md).
///
/// Needs no detection in a frame, as long as some evidence in the last half second told where to look. The
/// covariance is that of the fit, of what the model is known to leave out, and of the tags in the map; the
/// camera is taken as exact.
///
/// A reading that chance may make, of tag16h5 above all, starts nothing by itself: a map with several of
/// these needs two in one frame. The only tag of a map needs none, where no bit was corrected.
///
/// One recording at a time, frames in the order of time; a frame that is earlier than the one before by more
/// than 0.1 s starts anew, with a warning in its result: so does the one after a time stamp that is far
/// ahead. One that is not later is lost, and the motion goes on without it. Memory is bounded. No frame
/// throws, whatever it shows: a pose is finite, or there is none and the result says why.
///
/// One image at a time; give each thread its own. One that was moved from can only be destroyed, or assigned
/// to; anything else throws MisuseError.
class BlurTracker {
 public:
  /// Throws Error(kInvalidInput) when the map is empty, names an unknown family or id, or an option is out of
  /// its range.
  BlurTracker(const Camera& camera, const TagMap& map, const BlurTrackerOptions& options = {});
  ~BlurTracker();
  BlurTracker(BlurTracker&&) noexcept;
  BlurTracker& operator=(BlurTracker&&) noexcept;

  /// Builds the detector's tables now: up to seconds, and memory, for families with many codes. Without it
  /// the first image does; its latency_s does not count them. Those who bring detections need none.
  void prepare();

  /// An image of another resolution than the camera's is lost; its reason says so. Where the camera tells
  /// none, the first image's holds. An exposure of 0 is an instant: nothing is blurred; any other that
  /// is not from kMinExposure_s to kMaxExposure_s counts as unknown, with a warning in the result. One that
  /// is wrong by a factor of up to 25 is put right by the motion, where it moves enough
  /// (TrackResult::exposure).
  TrackResult track(const Frame& frame);
  /// The same with detections made elsewhere, by a detector of detector_options(): for instance several
  /// frames at a time.
  TrackResult track(const Frame& frame, const std::vector<Detection>& detections);

  /// What track(Frame) detects with: the options given, with the map's families and the camera's response.
  const DetectorOptions& detector_options() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace apriltrack
