#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>

#include "apriltrack/detect/detection.h"

namespace apriltrack::app {

/// How many detections of a file come without a covariance of their corners, and what is assumed for these.
struct CornerClaims {
  std::size_t detections = 0;
  std::size_t without_covariance = 0;
  /// Per axis; nullopt where nothing is assumed, or what the others have.
  std::optional<double> assumed_sigma_px;
};

/// Of `track`, which takes corners without a covariance to err by sigma_px.
CornerClaims corner_claims_of_track(std::span<const FrameDetections> frames, double sigma_px);

/// Of `calibrate`, which measures noise, and takes what a tag keeps in all of its views from the covariances
/// that there are, or for bias_px where there are none.
CornerClaims corner_claims_of_calibrate(std::span<const FrameDetections> frames, double bias_px);

/// {detections, without_covariance, assumed_sigma_px} (docs/file_formats.md).
nlohmann::json json_of(const CornerClaims& claims);

/// What the sigmas of `result` ("the poses", "the map") rest on, and the way out; empty where nothing is
/// assumed.
std::string in_words(const CornerClaims& claims, const std::string& result);

}  // namespace apriltrack::app
