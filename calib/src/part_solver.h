#pragma once

#include <optional>
#include <string>
#include <vector>

#include "better_cameras.h"
#include "constrained_map.h"
#include "print_batches.h"
#include "tag_covariance.h"
#include "tag_examination.h"

namespace apriltrack {

/// The map of one part, as adjusted.
struct PartSolution {
  int held_tag = 0;
  Part part;  ///< What was kept: outliers, and tags that hung on them alone, are gone.
  MapState state;
  std::vector<TagCovariance> covariances;  ///< Of part.tags; empty when these are too many.
  ErrorScale scale;
  JointCovariance joint;                      ///< Of part.tags; empty when these are too many.
  std::vector<double> residual_rms_px;        ///< Of part.tags, per axis.
  std::vector<MapConstraint> constraints;     ///< As given, cameras' gravity as that of tags.
  std::optional<ConstrainedMap> constrained;  ///< What constraints made of it; `state` is that already.
  double total_rms_px = 0.0;
  std::size_t views_offered = 0;              ///< Before outliers were removed.
  std::vector<int> views_offered_by_tag;      ///< Indexed like observations.tags.
  std::vector<std::string> lost_links;        ///< In words (words_of_lost_links, words_of_split_links).
  std::vector<std::size_t> rejected_at_rest;  ///< Rejected views from places where the camera stood.
  std::vector<int> culprits;                  ///< Left out, for the frames contradict each other with them.
  BetterCameras cameras;
  std::optional<PrintBatches> print_batches;
  std::optional<double> print_aspect;  ///< If it is not the lenses (find_print_aspect).
  std::vector<TimeError> time_errors;  ///< Those first that another part told.
  std::vector<TimeError> known_time_errors;
  bool are_cameras_given = false;  ///< Of another part: these views had no share in them.
  std::vector<TagFinding> findings;
  std::vector<int> undecided;     ///< Left out, for the views leave them two poses, and no fault says why.
  std::vector<int> contradicted;  ///< Left out, for most of their views were rejected.
  std::vector<int> lost_tags;     ///< Others that nothing trusted ties to the held tag.
};

/// What a part is solved by.
struct CamerasOfPart {
  const std::vector<RigCamera>& start;  ///< To begin with; `observations.cameras` is what is known of them.
  const std::vector<ViewCandidates>& candidates;  ///< Of all views, by these.
  /// What another part says of `start`: no part has cameras of its own. None: to be estimated.
  const BetterCameras* known = nullptr;
  std::vector<TimeError> time_errors = {};  ///< That it says of them.
};

/// Start, robust adjustment, outliers removed, clean adjustment, mirrored tags turned, covariances; all of it
/// again without the tag that makes frames contradict each other, if there is one, or those of which any may.
/// Throws Error(kNoResult) when it does not converge, converges to nonsense, or contradictions stay, of views
/// or of constraints. observations: in the end the edges of its views are those of the map where that moves
/// an edge offset (take_edges_from_map). constraints: whose tags are named by family and id.
PartSolution solve_part(Observations& observations, const CamerasOfPart& cameras, const Part& part,
                        int held_tag, const CalibrationOptions& options,
                        const std::vector<MapConstraint>& constraints, const ParallelFor& parallel,
                        const LogSink& log);

}  // namespace apriltrack
