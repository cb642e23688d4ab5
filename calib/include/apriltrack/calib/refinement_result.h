#pragma once

#include <string>
#include <vector>

#include "apriltrack/calib/calibration_finding.h"
#include "apriltrack/calib/joint_covariance.h"
#include "apriltrack/calib/map_constraints.h"
#include "apriltrack/calib/stop.h"
#include "apriltrack/tags/tag_map.h"

namespace apriltrack {

struct RefinementOptions {
  /// Moments that are looked at, spread evenly; more where a tag would be seen in fewer than a dozen of them.
  int max_moments = 150;
  /// Error of a tag's corners that it keeps in ALL of its views (print, light, lens model): as
  /// CalibrationOptions::corner_bias_px, of pictures. Counts for the covariance only; 0 = none. Where the
  /// frames' detections have covariances, what these claim takes its place.
  double picture_bias_px = 0.015;
  int num_threads = 1;          ///< 0 = as many as the machine has cores. The result does not depend on it.
  ShouldStop should_stop = {};  ///< refine_map() then returns soon, its map not accepted.

  /// Throws Error(kInvalidInput) that names the option, its value and its range.
  void check() const;
};

/// Of a camera's lens: standard deviation in px.
struct LensBlur {
  std::string camera;
  double sigma_px = 0.0;
};

struct RefinementResult {
  /// As calibrated, but where the refined one is accepted: the tags in `refined` at their new places, with
  /// their new covariances, and the flag "weak" by these.
  TagMap map;
  bool is_accepted = false;
  std::string reason;       ///< Why not.
  bool is_stopped = false;  ///< Not accepted, for RefinementOptions::should_stop said so.
  /// Sorted. Tags without pictures that can be used are not among them, and stay where the corners have them.
  std::vector<TagKey> refined;
  std::string gauge;                               ///< As CalibrationResult::gauge, of the refined map.
  std::vector<ConstraintAudit> constraint_audits;  ///< The same of the constraints.
  /// All of the calibration's that are true of the refined map, and what was found of that one: constraints
  /// in doubt, tags that stay as they are.
  std::vector<CalibrationFinding> findings;
  std::vector<std::string> warnings;  ///< The messages of `findings`.
  int moments_used = 0;
  int views_used = 0;  ///< Tags in images.
  /// How far the pictures of moments that the map was not made from disagree with it, in standard deviations
  /// (root mean square) of what noise would leave: before, and with a map refined from the others. Of
  /// pictures that are explained before; those that the other map explains no more count there as five
  /// medians.
  double held_out_before = 0.0, held_out_after = 0.0;
  /// Of the refined tags, by their pictures, and the held one where pictures show it; where it is accepted.
  JointCovariance joint;
  std::vector<LensBlur> lens_blurs;  ///< Of the cameras whose pictures were used, in the order of the rig.
};

}  // namespace apriltrack
