#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apriltrack/base/log.h"
#include "apriltrack/calib/cross_validation.h"
#include "apriltrack/calib/map_constraints.h"
#include "apriltrack/calib/map_evidence.h"
#include "apriltrack/calib/stop.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detection.h"
#include "apriltrack/tags/tag_map.h"
#include "apriltrack/tags/tag_sizes.h"

namespace apriltrack {

enum class Intrinsics {
  kKeep,   ///< As given.
  kAuto,   ///< Refined where held-out frames agree better by 5 % or more, and no faulty tag is why.
  kRefine  ///< Refined where such frames agree better at all, by more than chance.
};

struct CalibrationOptions {
  /// The tag that is held at the map's origin; by default the first (smallest key) tag of the largest part.
  std::optional<TagKey> held_tag = std::nullopt;
  /// What is known beside the images: distances, measured coordinates, gravity, ... Those that refer to the
  /// map's frame fix it; the held tag then lies where they put it, and keeps what they leave open.
  std::vector<MapConstraint> constraints = {};
  /// Expected error normal to a tag's edge at one of its ends. For the covariance it counts as three
  /// residuals beside those of the fit: many views speak for themselves, few claim no more than this.
  double corner_sigma_px = 0.15;
  /// Correlation of those errors between the two ends of an edge: -0.5 for corners that are intersections of
  /// lines fitted to the edges. In (-1, 1).
  double edge_end_correlation = -0.45;
  /// Error of the same kind that a tag keeps in ALL of its views (lens model, uneven light, print): it does
  /// not average, and the fit hides most of it from the residuals. Counts for the covariance only; 0 = none.
  /// Of corners whose detector tells no covariance: where covariances are told, what they claim takes its
  /// place (docs/algorithms/calibration.md).
  double corner_bias_px = 0.05;
  /// How far a detector's edges may lie inside or outside the true ones (px, along their normals, the same
  /// for all tags): estimated with this sigma where it is > 0, and taken over where frames that were held out
  /// agree. For corners from elsewhere; those of detect_tags() in linear light have none to speak of.
  double edge_offset_sigma_px = 0.0;
  /// Whether focal lengths, principal point and distortion are estimated with the map, near what the camera
  /// file says.
  Intrinsics intrinsics = Intrinsics::kAuto;
  /// The same, as kRefine, for where cameras sit on the rig.
  bool refine_extrinsics = false;
  /// Larger maps go without covariances, with a warning: they take 0.3 kB times the square of the number of
  /// tags, and 0.4 kB for each two that are seen together (1000 tags: 0.3 to 0.7 GB).
  int max_tags_with_covariance = 1000;
  /// Larger maps go without the covariances between their tags (joint_covariance.h): 0.7 kB times the square
  /// of the number of tags, of which some copies are in memory at once (refinement and advice have theirs).
  int max_tags_with_joint_covariance = 100;
  /// Solve the map from each half of the recording, too, and tell how far the two differ
  /// (CalibrationResult::cross_validation): two more adjustments.
  bool cross_validate = false;
  /// Frames whose tags' corners differ by less (rms) are of a scene at rest, and count as one view, with
  /// their mean: what errs in them is common to them, and does not average. 0 = every frame counts.
  double same_place_px = 1.0;
  /// Tags seen in fewer frames together with others, those of one place counted once, are left out and named.
  int min_views = 2;
  int max_iterations = 100;
  int num_threads = 1;  ///< 0 = as many as the machine has cores. The result does not depend on it.
  std::string map_frame = "world";
  ShouldStop should_stop = {};  ///< calibrate_map() then throws Stopped, soon.

  /// Throws Error(kInvalidInput) that names the option, its value and its range.
  void check() const;
};

/// A number of a camera that was estimated with the map.
struct CameraCorrection {
  std::string camera;
  std::string parameter;  ///< "edge offset", "focal length", "fy / fx", "cx", "k1", "translation x", ...
  std::string unit;       ///< "px", "1" (a share, or a coefficient), "m", "rad".
  double value = 0.0;     ///< To be added to what was given; of lengths and ratios a share of that.
  double sigma = 0.0;     ///< Of lengths and ratios a share of what the camera has now.

  bool is_of_edges() const { return parameter == "edge offset"; }  ///< Of the detector, not of the camera.
};

/// Tags that look like two prints of different size: alike among themselves, and one larger than the other.
struct PrintBatches {
  std::vector<TagKey> larger, smaller;
  double log_ratio = 0.0;  ///< Of the one to the other, beside what their stated sizes say.
  double sigma = 0.0;
};

/// Pictures of a camera that are not of the moments that their times say.
struct TimeError {
  enum class Kind {
    kReadout,  ///< Its rows were taken one after another: from the first to the last, s.
    kDelay     ///< All of it was taken later than what `first_camera` saw at the same time: by so much, s.
  };
  std::string camera;
  Kind kind = Kind::kReadout;
  double value_s = 0.0;
  double sigma_s = 0.0;
  std::string first_camera = {};
};

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
  std::vector<std::string> warnings;
  std::vector<std::string> constraint_doubts;  ///< Those of the warnings: constraints in doubt.
  std::vector<TagKey> left_out;                ///< Seen, but in no map: the warnings say why.
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

/// Builds a tag map by bundle adjustment: connectivity first, planar solutions resolved, spanning-tree start,
/// robust adjustment with one tag held (docs/algorithms/calibration.md).
///
/// frames: in any order, each camera's with times of their own; those of several cameras with equal time
/// share the rig's pose. rig: needs extrinsics only when several of its cameras were used.
///
/// The tags' covariances rest on the residuals that are left (their size, and how much neighbouring frames
/// repeat them) and on corner_bias_px. Errors that all tags share (a lens that is not the file's, prints that
/// are not as stated) are in them only where they were estimated, or where the views clearly propose them
/// (open_corrections, print_batches, print_aspect, time_errors).
///
/// Throws Error(kNoResult) when no two tags connect, ids are not unique, the adjustment does not converge, or
/// a constraint contradicts all else, and says what to do; Error(kInvalidInput) when a size is missing, a
/// camera is unknown or has two frames of one time, or the held tag or one that a constraint names was never
/// seen. Throws Stopped where the options say so.
CalibrationResult calibrate_map(std::span<const FrameDetections> frames, const CameraRig& rig,
                                const TagSizes& sizes, const CalibrationOptions& options,
                                const LogSink& log = silent_log());

}  // namespace apriltrack
