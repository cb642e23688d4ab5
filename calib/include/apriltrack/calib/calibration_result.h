#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "apriltrack/calib/calibration_finding.h"
#include "apriltrack/calib/cross_validation.h"
#include "apriltrack/calib/map_constraints.h"
#include "apriltrack/calib/map_evidence.h"
#include "apriltrack/calib/systematic_errors.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/tags/tag_map.h"

namespace apriltrack {

/// What calibrate_map() makes of a recording.
struct CalibrationResult {
  TagMap map;  ///< The part with the held tag; tags in the order of their keys.
  /// Parts that no frame joins to it, each with a gauge of its own; largest first.
  std::vector<TagMap> other_parts;
  std::vector<TagKey> held_tags_of_other_parts;  ///< At their origins.
  TagKey held_tag;                    ///< At the origin of `map`, unless constraints say where it is.
  std::string gauge;                  ///< How the map's frame was fixed, in words.
  bool is_frame_measured = false;     ///< By constraints: no tag is held, and covariances are of that frame.
  bool is_vertical_measured = false;  ///< By these: z of the map's frame is up.
  /// Those that `map` keeps to, their tags named by family and id; and each one of the options against all
  /// else.
  std::vector<MapConstraint> constraints;
  std::vector<ConstraintAudit> constraint_audits;
  std::vector<CalibrationFinding> findings;  ///< What is wrong or weak, with tags and numbers.
  std::vector<std::string> warnings;         ///< The messages of `findings`.
  std::vector<TagKey> left_out;              ///< Seen, but in no map: `findings` say why. Sorted.
  // Of `map`:
  double residual_rms_px = 0.0;  ///< Per axis, of the observations used.
  int frames_used = 0;
  double solve_s = 0.0;           ///< Wall-clock time, from corners to this.
  int frames_at_rest = 0;         ///< Beside these, of all parts: in the mean of another one.
  int observations_used = 0;      ///< Tags in images.
  int observations_rejected = 0;  ///< Outliers.
  /// The cameras that `map` rests on: as given, but for the corrections.
  CameraRig rig;
  std::vector<CameraCorrection> corrections;  ///< None where the cameras are as given.
  Eigen::MatrixXd corrections_covariance;     ///< Of these, in their order and units.
  /// What the views say besides, but too few frames decide: `map` is without it, and its covariances count
  /// it.
  std::vector<CameraCorrection> open_corrections;
  Eigen::MatrixXd open_covariance;  ///< About the cameras as they are, in the order and units of these.
  /// The map is by the stated sizes, and its covariances count that either print may be as stated.
  std::optional<PrintBatches> print_batches;
  /// By how much tags may be printed wider than high, if the lenses' fy / fx is not what it looks like; it is
  /// in the covariances.
  std::optional<double> print_aspect;
  /// That the views clearly propose; `map` is without them, and its covariances count them.
  std::vector<TimeError> time_errors;
  /// At the moments that `map` rests on, in the order of time.
  std::vector<RigPose> rig_poses;
  MapEvidence evidence;                              ///< What `map` rests on.
  std::vector<MapEvidence> evidence_of_other_parts;  ///< The same, in the order of `other_parts`.
  std::optional<CrossValidation> cross_validation;   ///< Where it was asked for.
};

}  // namespace apriltrack
