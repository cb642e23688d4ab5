#pragma once

#include <array>
#include <optional>
#include <vector>

#include "apriltrack/camera/camera_model.h"
#include "apriltrack/detect/detection.h"
#include "apriltrack/geometry/planar_pnp.h"
#include "apriltrack/tags/tag_index.h"
#include "apriltrack/tags/tag_map.h"

namespace apriltrack {

/// A detection of a mapped tag with all that a pose can be judged by.
struct TagObservation {
  const MapTag* tag = nullptr;
  int tag_index = 0;  ///< Into the map's tags.
  std::array<Eigen::Vector3d, kNumCorners> corners_map;
  std::array<Eigen::Vector2d, kNumCorners> corners_px;
  PlanarPoses planar_poses;  ///< Both T_camera_tag; may be empty.
  int corrected_bits = 0;    ///< 0 where the detection does not say.
  /// Of the corners' errors, as the detector gives it; nullopt where it gives none.
  std::optional<CornerCovariance> claimed_covariance_px2 = std::nullopt;
  /// Of the corners' errors, as expected of a camera at rest (corner_noise.h).
  CornerCovariance covariance_px2 = CornerCovariance::Identity();
  /// Its inverse's symmetric square root: whitened errors W (x0 y0 x1 y1 ...) have the identity's covariance.
  CornerCovariance whitening_per_px = CornerCovariance::Identity();
  double log_determinant = 0.0;  ///< Of covariance_px2.
  bool is_repeated = false;      ///< The frame shows this tag more than once: at most one of them can be it.
};

/// The same, with further errors that are independent in each coordinate.
TagObservation with_further_noise(TagObservation observation, double sigma_px);

/// Leaves out tags that the map does not have, corners that no ray of the lens model reaches, and those whose
/// covariance is not finite or not positive. The
/// observations point into `map`, which must outlive them. index: the map's. sharp_sigma_px: of corners
/// without a covariance, per axis.
std::vector<TagObservation> observe_mapped_tags(const TagMap& map, const TagIndex& index,
                                                const CameraModel& model,
                                                const std::vector<Detection>& detections,
                                                double sharp_sigma_px);

/// How many different tags there are; copies of one count once.
int count_tags(const std::vector<TagObservation>& observations);
int count_tags(const std::vector<const TagObservation*>& observations);

}  // namespace apriltrack
