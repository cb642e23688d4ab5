#include "apriltrack/camera/camera.h"

#include <fmt/format.h>

#include "apriltrack/base/check.h"
#include "apriltrack/base/error.h"

namespace apriltrack {

const Camera& CameraRig::find(const std::string& name) const {
  std::string names;
  for (const Camera& camera : cameras) {
    if (camera.name == name) return camera;
    names += (names.empty() ? "" : ", ") + camera.name;
  }
  throw invalid_input({}, fmt::format("there is no camera '{}'; the camera file has {}", name, names));
}

Pose CameraRig::T_camera_rig(std::size_t index) const {
  APRILTRACK_CHECK(index < cameras.size(), "no such camera");
  Pose T_camera_rig;
  for (std::size_t i = 1; i <= index; ++i) {
    if (!cameras[i].T_this_previous) {
      throw invalid_input(
          {}, fmt::format("camera '{}' has no T_cn_cnm1, its place relative to '{}'; add it to the "
                          "camera file or use one camera only",
                          cameras[i].name, cameras[i - 1].name));
    }
    T_camera_rig = *cameras[i].T_this_previous * T_camera_rig;
  }
  return T_camera_rig;
}

void check_resolution(const Camera& camera, int image_width, int image_height, const std::string& where) {
  const bool is_unknown = camera.width == 0 && camera.height == 0;
  if (is_unknown || (camera.width == image_width && camera.height == image_height)) return;
  throw invalid_input(
      where, fmt::format("is {} x {} pixels, but camera '{}' is calibrated for {} x {}; use the camera "
                         "file of this resolution",
                         image_width, image_height, camera.name, camera.width, camera.height));
}

}  // namespace apriltrack
