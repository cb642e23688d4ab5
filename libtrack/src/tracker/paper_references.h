#pragma once

#include <cstddef>
#include <vector>

#include "apriltrack/image/image.h"
#include "apriltrack/photometric/joint_likelihood.h"
#include "tag_observation.h"

namespace apriltrack {

/// Scores of one hypothesis, tag by tag, with what they say together.
struct PaperEvidence {
  double mean_correlation = 0.0;  ///< Each tag weighed by what is seen of it.
  int num_agreeing = 0;           ///< Tags that correlate enough.
  bool has_detected = false;      ///< A tag detected in this frame agrees.
};

/// The patches by which the paper's tracker knows its tags: those of their last detections, kept in the
/// likelihood.
class PaperReferences {
 public:
  /// likelihood: of the map's tags, outlives this.
  PaperReferences(const CameraModel& model, const TagMap& map, const PatchGrid& grid,
                  JointLikelihood& likelihood)
      : model_(model), map_(map), index_(map), grid_(grid), likelihood_(likelihood) {}

  /// The patch of every tag seen is its reference from now on, this frame included. A tag that the frame
  /// shows twice is left out: any copy may be the false one.
  void renew(const ImageView<const float>& grey, const std::vector<Detection>& detections);
  /// Of the hypothesis `index`; tags of which less than a quarter is seen say nothing.
  PaperEvidence weigh(const JointScores& scores, std::size_t index, double min_correlation) const;
  /// Tags that correlate less with the hypothesis `index` wait for their next detection.
  void discard(const JointScores& scores, std::size_t index, double least_correlation);
  void forget();

 private:
  const CameraModel& model_;
  const TagMap& map_;
  TagIndex index_;  ///< Of the map's tags.
  PatchGrid grid_;
  JointLikelihood& likelihood_;
  std::vector<bool> is_detected_;  ///< In this frame, by tag of the map.
};

}  // namespace apriltrack
