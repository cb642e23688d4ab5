#include <fmt/format.h>

#include "apriltrack/base/error.h"
#include "apriltrack/io/numbers.h"
#include "writers.h"

namespace apriltrack {

std::vector<double> coefficients_of(const CameraModel& model) {
  return std::visit([](const auto& lens) { return lens.coefficients(); }, model.distortion());
}

std::vector<double> radtan_coefficients(const Camera& camera, std::string_view format) {
  if (std::holds_alternative<EquidistantDistortion>(camera.model.distortion())) {
    throw invalid_input(
        {}, fmt::format("camera '{}' has the lens model equidistant (fisheye), which a {} file cannot "
                        "hold; calibrate with radtan, or choose a format that has fisheyes: kalibr, "
                        "ros, opencv, colmap",
                        camera.name, format));
  }
  std::vector<double> coefficients = coefficients_of(camera.model);
  if (coefficients.size() < 5) coefficients.resize(5, 0.0);
  return coefficients;
}

std::string joined(const std::vector<double>& numbers, std::string_view between) {
  std::string text;
  for (const double number : numbers) {
    if (!text.empty()) text += between;
    text += format_exact(number);
  }
  return text;
}

std::vector<double> matrix_of(const CameraModel& model) {
  const Pinhole& lens = model.pinhole();
  return {lens.fx, 0.0, lens.cx, 0.0, lens.fy, lens.cy, 0.0, 0.0, 1.0};
}

}  // namespace apriltrack
