#pragma once

#include <cstdint>
#include <vector>

#include "apriltrack/detect/detection.h"
#include "apriltrack/sim/renderer.h"
#include "apriltrack/tracker/blur_tracker.h"

namespace apriltrack::test {

/// A short film of the simulator's with its exact truth, and what the detector finds in it.
struct BlurFilm {
  Scene scene;
  std::vector<RenderedFrame> frames;
  std::vector<std::vector<Detection>> detections;
  std::vector<double> blur_px;  ///< Longest path of a tag's corner during the exposure.

  BlurFilm(Scene filmed, std::uint64_t noise_seed);

  std::size_t size() const { return frames.size(); }
  /// Mean distance of the corners of the tags that face the camera in frame `index`, where `pose` (of the
  /// film's own kind) and the truth put them.
  double corner_error_px(std::size_t index, const Pose& pose) const;
};

/// A tag of 100 px in a camera of 320 x 240, waved: its corners run at most 3.2 px during the exposure of the
/// first three frames and of the last seven, up to 42 px between.
const BlurFilm& waved_tag();
/// The tag of waved_tag(), waved so wildly that it leaves the image and comes back: up to 100 px.
const BlurFilm& wild_tag();
/// A small tag at rest, sharp: its corners fit two poses.
const BlurFilm& far_tag();
/// The same tag at rest for 30 frames, nearer.
const BlurFilm& still_tag();
/// Three tags on two walls of a corner, in a camera that is shaken: up to 34 px.
const BlurFilm& shaken_camera();
/// The tags of shaken_camera(), in a camera that swings to and fro in 9.5 frames: sharp at first, where it
/// turns about, up to 43 px blurred; other turns lie between frames that are blurred by 14 px on both sides.
const BlurFilm& swung_camera();
/// The same with other noise.
BlurFilm swung_camera_with(std::uint64_t seed);

/// In the film's mode, with a cloud of a quarter of the usual size, so that tests are quick.
BlurTracker tracker_of(const BlurFilm& film, std::uint64_t seed = 0, int num_particles = 60);
/// The film from frame `first` on, with what its detector found.
std::vector<TrackResult> tracked(BlurTracker tracker, const BlurFilm& film, std::size_t first = 0);
/// Claimed: `detected` or `tracked`.
bool has_evidence(const TrackResult& result);

}  // namespace apriltrack::test
