#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <variant>
#include <vector>

#include "apriltrack/camera/camera.h"

namespace apriltrack::test {

/// The text of a camera file as WPILib writes it, without a resolution.
inline std::string wpilib_text(const CameraModel& model) {
  const Pinhole& lens = model.pinhole();
  std::vector<double> coefficients =
      std::visit([](const auto& one) { return one.coefficients(); }, model.distortion());
  coefficients.resize(8, 0.0);
  return nlohmann::json{{"camera_matrix", {lens.fx, 0, lens.cx, 0, lens.fy, lens.cy, 0, 0, 1}},
                        {"distortion_coefficients", coefficients},
                        {"avg_reprojection_error", 0.1}}
      .dump();
}

}  // namespace apriltrack::test
