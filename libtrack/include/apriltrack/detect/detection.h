#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "apriltrack/base/timestamp.h"
#include "apriltrack/detect/tag_patch.h"
#include "apriltrack/tags/tag_corners.h"
#include "apriltrack/tags/tag_key.h"

namespace apriltrack {

using CornerCovariance = Eigen::Matrix<double, 8, 8>;

/// One tag found in one image.
struct Detection {
  TagKey tag;
  /// Raw (distorted) pixels, (0, 0) = CENTRE of the top-left pixel; bottom-left, bottom-right, top-right,
  /// top-left.
  std::array<Eigen::Vector2d, kNumCorners> corners_px;
  std::optional<int> hamming;  ///< Bits corrected; unknown when corners come from a file without it.
  std::optional<double>
      decision_margin;  ///< Grey levels between a bit and its threshold, mean over the bits.
  /// Of the corners' errors, x0 y0 x1 y1 ..., px^2; nullopt where nobody told it.
  std::optional<CornerCovariance> covariance_px2 = std::nullopt;
};

/// The detections of one frame of one camera: what a calibration starts from.
struct FrameDetections {
  Timestamp timestamp;
  std::string camera = "cam0";
  std::vector<Detection> detections;
  /// Of some detections or none: what photometric refinement looks at (calib/refine_map.h).
  std::vector<TagPatch> patches = {};
  std::optional<double> exposure_s = std::nullopt;  ///< Of this frame, where it is told.
};

}  // namespace apriltrack
