#include "corner_claims.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace apriltrack::app {
namespace {

CornerClaims counted(std::span<const FrameDetections> frames) {
  CornerClaims claims;
  for (const FrameDetections& frame : frames) {
    claims.detections += frame.detections.size();
    for (const Detection& detection : frame.detections)
      claims.without_covariance += detection.covariance_px2 ? 0 : 1;
  }
  return claims;
}

}  // namespace

CornerClaims corner_claims_of_track(std::span<const FrameDetections> frames, double sigma_px) {
  CornerClaims claims = counted(frames);
  if (claims.without_covariance > 0) claims.assumed_sigma_px = sigma_px;
  return claims;
}

CornerClaims corner_claims_of_calibrate(std::span<const FrameDetections> frames, double bias_px) {
  CornerClaims claims = counted(frames);
  if (claims.without_covariance == claims.detections && claims.detections > 0)
    claims.assumed_sigma_px = bias_px;
  return claims;
}

nlohmann::json json_of(const CornerClaims& claims) {
  nlohmann::json json = {{"detections", claims.detections},
                         {"without_covariance", claims.without_covariance},
                         {"assumed_sigma_px", nullptr}};
  if (claims.assumed_sigma_px) json["assumed_sigma_px"] = *claims.assumed_sigma_px;
  return json;
}

std::string in_words(const CornerClaims& claims, const std::string& result) {
  if (claims.without_covariance == 0) return "";
  const std::string assumed = claims.assumed_sigma_px ? fmt::format("an assumed error of {:.2g} px per axis",
                                                                    *claims.assumed_sigma_px)
                                                      : "the assumption that these err like the others";
  return fmt::format(
      "{} of {} detections have no covariance of their corners: the sigmas of {} rest on {}; give the "
      "columns cov_00 to cov_77, as `apriltrack detect` writes them",
      claims.without_covariance, claims.detections, result, assumed);
}

}  // namespace apriltrack::app
