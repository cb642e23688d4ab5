#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apriltrack/base/log.h"
#include "apriltrack/calib/calibrate_map.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detection.h"

namespace apriltrack {

struct RefinementOptions {
  /// Moments that are looked at, spread evenly; more where a tag would be seen in fewer than a dozen of them.
  int max_moments = 150;
  /// Error of a tag's corners that it keeps in ALL of its views (print, light, lens model): as
  /// CalibrationOptions::corner_bias_px, of pictures. Counts for the covariance only; 0 = none.
  double picture_bias_px = 0.015;
  int num_threads = 1;  ///< 0 = as many as the machine has cores. The result does not depend on it.

  /// Throws Error(kInvalidInput) that names the option, its value and its range.
  void check() const;
};

struct RefinementResult {
  /// As calibrated, but where the refined one is accepted: the tags in `refined` at their new places, with
  /// their new covariances.
  TagMap map;
  bool is_accepted = false;
  std::string reason;                              ///< Why not.
  std::vector<TagKey> refined;                     ///< Sorted.
  std::string gauge;                               ///< As CalibrationResult::gauge, of the refined map.
  std::vector<ConstraintAudit> constraint_audits;  ///< The same of the constraints.
  std::vector<std::string> warnings;               ///< Constraints in doubt.
  int moments_used = 0;
  int views_used = 0;  ///< Tags in images.
  /// How far the pictures of moments that the map was not made from disagree with it, in standard deviations
  /// (root mean square) of what noise would leave: before, and with a map refined from the others.
  double held_out_before = 0.0, held_out_after = 0.0;
  JointCovariance joint;             ///< Of the refined tags, by their pictures; where it is accepted.
  std::vector<double> psf_sigma_px;  ///< Blur of each camera's lens, in the order of the rig.
};

/// Refines a calibrated map on the pictures of its tags: Gauss-Newton on the light of all their pixels, with
/// the blur of the lens and the light that falls on each tag as unknowns beside all poses
/// (docs/algorithms/photometric_refinement.md).
///
/// frames: those that `calibration` was made from, with their patches; frames without take no part. The
/// refined map is accepted only where the pictures of every fourth moment agree better with a map refined
/// from the other three.
///
/// The refined map keeps to the calibration's constraints. Throws Error(kNoResult) where they contradict the
/// pictures, Error(kInvalidInput) for an option out of range or a camera that the rig does not have.
RefinementResult refine_map(const CalibrationResult& calibration, std::span<const FrameDetections> frames,
                            const CameraRig& rig, const RefinementOptions& options,
                            const LogSink& log = silent_log());

}  // namespace apriltrack
