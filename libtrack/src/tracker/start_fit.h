#pragma once

#include <vector>

#include "apriltrack/photometric/motion_fit.h"
#include "apriltrack/tracker/blur_tracker.h"
#include "blur_frame.h"
#include "explanation.h"
#include "motion_memory.h"

namespace apriltrack {

/// A state from which a frame's explanation may be found.
struct MotionStart {
  MotionState state;
  MotionHypothesis prior;
  bool is_cold;  ///< As Explanation's.
};

/// Where a start leads in coarse pixels alone.
struct Sketch {
  MotionStart start;
  double score;
};

/// Finds the explanations of a frame that starts lead to, and what they are worth. A view of the world and
/// the options, which must outlive it.
class StartFit {
 public:
  StartFit(PhotometricWorld& world, const BlurTrackerOptions& options) : world_(world), options_(options) {}

  PhotometricWorld& world() const { return world_; }
  const BlurTrackerOptions& options() const { return options_; }

  Explanation explained(const BlurFrame& frame, const MotionStart& start,
                        const MotionFitOptions& options) const;
  /// On levels coarsest_level to 1.
  Sketch sketched(const BlurFrame& frame, MotionStart start, int coarsest_level) const;
  /// As Explanation's, of its state and prior.
  Matrix6d bend_covariance_of(const BlurFrame& frame, const Explanation& explanation) const;

 private:
  /// The fit from `start`, with the noise of corners that its own motion makes.
  MotionFit fitted(const BlurFrame& frame, const MotionStart& start, MotionFitOptions options) const;
  /// Without the tags that the frame reads as others: neither the state nor its covariance may rest on them.
  void refit_without_tags_read_as_others(const BlurFrame& frame, Explanation& explanation) const;
  std::vector<CornerObservation> corners(const BlurFrame& frame, const MotionState& state) const;
  TagVotes votes(const BlurFrame& frame, const MotionState& state) const;

  PhotometricWorld& world_;
  const BlurTrackerOptions& options_;
};

}  // namespace apriltrack
