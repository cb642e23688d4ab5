#include <fmt/format.h>

#include "colmap.h"
#include "writers.h"

namespace apriltrack {
namespace {

std::string colmap_model(const CameraModel& model) {
  if (std::holds_alternative<NoDistortion>(model.distortion())) return "PINHOLE";
  if (std::holds_alternative<EquidistantDistortion>(model.distortion())) return "OPENCV_FISHEYE";
  return coefficients_of(model).size() == 4 ? "OPENCV" : "FULL_OPENCV";
}

std::string camera_line(std::size_t id, const Camera& camera) {
  const std::string model = colmap_model(camera.model);
  const Pinhole& lens = camera.model.pinhole();
  std::vector<double> coefficients = coefficients_of(camera.model);
  if (model == "FULL_OPENCV") coefficients.resize(8, 0.0);
  std::vector<double> values = {lens.fx, lens.fy, lens.cx + kColmapPixelOffset_px,
                                lens.cy + kColmapPixelOffset_px};
  values.insert(values.end(), coefficients.begin(), coefficients.end());
  return fmt::format("{} {} {} {} {}\n", id, model, camera.width, camera.height, joined(values, " "));
}

}  // namespace

std::string colmap_text(const std::vector<Camera>& cameras) {
  std::string text = fmt::format(
      "# Camera list with one line of data per camera:\n"
      "#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n"
      "# Number of cameras: {}\n",
      cameras.size());
  for (std::size_t i = 0; i < cameras.size(); ++i) text += camera_line(i + 1, cameras[i]);
  return text;
}

}  // namespace apriltrack
