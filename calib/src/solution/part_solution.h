#pragma once

#include <optional>
#include <vector>

#include "apriltrack/calib/joint_covariance.h"
#include "apriltrack/calib/map_constraints.h"
#include "apriltrack/calib/systematic_errors.h"
#include "constraints/constrained_map.h"
#include "faults/lost_links.h"
#include "faults/rejected_stands.h"
#include "faults/split_links.h"
#include "hypotheses/better_cameras.h"
#include "model/tag_finding.h"
#include "uncertainty/error_scale.h"
#include "uncertainty/tag_covariance.h"

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
  std::size_t views_offered = 0;          ///< Before outliers were removed.
  std::vector<int> views_offered_by_tag;  ///< Indexed like observations.tags.
  std::vector<LostLink> lost_links;
  std::vector<SplitLink> split_links;
  std::vector<RejectedStand> rejected_stands;
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

}  // namespace apriltrack
