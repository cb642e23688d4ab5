#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "apriltrack/tracker/blur_tracker.h"
#include "blur_corners.h"
#include "explanation.h"
#include "motion_memory.h"
#include "path_bend.h"
#include "pose_candidate.h"
#include "tag_observation.h"

namespace apriltrack {

/// One frame, ready to be explained.
struct BlurFrame {
  PhotometricFrame photometric;
  std::vector<Detection> detections;
  std::vector<TagObservation> read;          ///< Of them, those of mapped tags;
  std::vector<TagObservation> observations;  ///< of these, those that take part.
  bool is_searched = false;          ///< Tags were looked for everywhere, not only where they are expected.
  std::uint64_t index = 0;           ///< In the recording: the key of its random numbers.
  std::optional<double> interval_s;  ///< Since the frame before that was explained.
  std::optional<double> step_s;      ///< Since that, or the last turn seen.
  double sensitivity = 1.0;          ///< Light in the image for light in the scene: exposure times gain. > 0.
};

/// Another path beside one that was found.
struct PathVariation {
  double factor;       ///< Of the velocity.
  double shift = 0.0;  ///< Of the middle, forward, in exposures.
};

/// Finds the states that explain frames: from the motion so far, from detections, and from a cloud of
/// particles where neither does.
class BlurExplainer {
 public:
  BlurExplainer(PhotometricWorld& world, const BlurTrackerOptions& options)
      : world_(world), options_(options) {}

  /// Best first; empty when there is neither a hypothesis nor a detection. hypotheses: of this frame's time,
  /// the likeliest first.
  std::vector<Explanation> explain(const BlurFrame& frame, const std::vector<MotionHypothesis>& hypotheses);

 private:
  struct Start {
    MotionState state;
    MotionHypothesis prior;
    bool is_cold;
  };

  /// Where a start leads in coarse pixels alone.
  struct Sketch {
    Start start;
    double score;
  };

  /// From what the motion so far predicts: the likeliest, and the others where it settles nothing.
  std::vector<Explanation> expected(const BlurFrame& frame, const std::vector<MotionHypothesis>& hypotheses);
  /// Adds those that begin at the poses that detected corners allow.
  void detected(const BlurFrame& frame, const std::vector<MotionHypothesis>& hypotheses,
                std::vector<Explanation>& found);
  /// At a pose that corners allow, with the velocities that the hypotheses expect there; cold where none
  /// does.
  std::vector<Start> starts_at(const PoseCandidate& candidate,
                               const std::vector<MotionHypothesis>& hypotheses) const;
  /// The motion went on as expected, the tags look as they should, and every detection agrees: no other start
  /// is needed.
  static bool is_settled(const BlurFrame& frame, const Explanation& explanation);
  /// The best path in these variations; the best of them is fitted where it is better.
  void vary_path(const BlurFrame& frame, std::span<const PathVariation> variations,
                 std::vector<Explanation>& found);
  /// Where the blur is long: shorter and longer paths, while one is better.
  void vary_length(const BlurFrame& frame, std::vector<Explanation>& found);
  /// On levels coarsest_level to 1.
  Sketch sketched(const BlurFrame& frame, Start start, int coarsest_level);
  /// What the clouds are drawn about.
  static std::vector<Start> search_bases(const std::vector<MotionHypothesis>& hypotheses,
                                         const std::vector<Explanation>& found);
  /// In clouds of particles, until something explains the frame.
  void search(const BlurFrame& frame, const std::vector<MotionHypothesis>& hypotheses,
              std::vector<Explanation>& found);
  /// cloud: 0, or 1 for the one after.
  void search_in_cloud(const BlurFrame& frame, const std::vector<MotionHypothesis>& hypotheses,
                       std::size_t cloud, std::vector<Explanation>& found);
  PathBend bend_of(const BlurFrame& frame, const Explanation& explanation) const;
  /// Adds the other tilt of a lone tag where the motion so far does not rule it out.
  void mirror(const BlurFrame& frame, std::vector<Explanation>& found);
  /// Adds the best explanation's reverse where the next frame could tell them apart.
  void reverse(const BlurFrame& frame, std::vector<Explanation>& found);
  Explanation explained(const BlurFrame& frame, const Start& start, const MotionFitOptions& options);
  /// The fit from `start`, with the noise of corners that its own motion makes.
  MotionFit fitted(const BlurFrame& frame, const Start& start, MotionFitOptions options);
  std::vector<CornerObservation> corners(const BlurFrame& frame, const MotionState& state) const;
  TagVotes votes(const BlurFrame& frame, const MotionState& state) const;
  PhotometricTag& tag_of(const TagEvidence& evidence) {
    return world_.tags[static_cast<std::size_t>(evidence.tag_index)];
  }
  /// Without the tags that the frame reads as others: neither the state nor its covariance may rest on them.
  void refit_without_tags_read_as_others(const BlurFrame& frame, Explanation& explanation);

  PhotometricWorld& world_;
  const BlurTrackerOptions& options_;
};

}  // namespace apriltrack
