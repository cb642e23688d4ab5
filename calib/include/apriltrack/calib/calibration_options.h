#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apriltrack/calib/map_constraints.h"
#include "apriltrack/calib/stop.h"
#include "apriltrack/tags/tag_key.h"

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

}  // namespace apriltrack
