#pragma once

#include "apriltrack/camera/camera.h"

namespace apriltrack {

/// Which part of a sensor the pictures show, and how many of its pixels each of theirs joins: `roi` and
/// `binning` of ROS's CameraInfo (REP 104), whose matrix is of the whole sensor.
struct SensorWindow {
  int x_offset = 0;  ///< In pixels of the sensor, as are width and height.
  int y_offset = 0;
  int width = 0;  ///< 0: as wide as the sensor.
  int height = 0;
  int binning_x = 1;  ///< 1 or more.
  int binning_y = 1;
};

/// The camera of such pictures; `whole` is that of the sensor. Pixel 0 of a picture covers pixels 0 to
/// binning - 1 of the part, and its centre is theirs.
Camera camera_of_window(const Camera& whole, const SensorWindow& window);

}  // namespace apriltrack
