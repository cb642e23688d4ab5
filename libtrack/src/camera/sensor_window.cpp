#include "apriltrack/camera/sensor_window.h"

#include "apriltrack/base/check.h"

namespace apriltrack {
namespace {

double centre_in_window(double centre, int offset, int binning) {
  return (centre - offset - 0.5 * (binning - 1)) / binning;
}

}  // namespace

Camera camera_of_window(const Camera& whole, const SensorWindow& window) {
  APRILTRACK_CHECK(window.binning_x >= 1 && window.binning_y >= 1,
                   "a picture's pixel joins one of the sensor's or more");
  const Pinhole& lens = whole.model.pinhole();
  Camera camera = whole;
  camera.model = CameraModel({lens.fx / window.binning_x, lens.fy / window.binning_y,
                              centre_in_window(lens.cx, window.x_offset, window.binning_x),
                              centre_in_window(lens.cy, window.y_offset, window.binning_y)},
                             whole.model.distortion());
  camera.width = (window.width > 0 ? window.width : whole.width) / window.binning_x;
  camera.height = (window.height > 0 ? window.height : whole.height) / window.binning_y;
  return camera;
}

}  // namespace apriltrack
