#include "apriltrack/camera/camera.h"

#include <fmt/format.h>

#include <cstdint>

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
  throw invalid_input(where, fmt::format("is {} x {} pixels, but camera '{}' is calibrated for {} x {}; {}",
                                         image_width, image_height, camera.name, camera.width, camera.height,
                                         advice_on_resolution(camera, image_width, image_height)));
}

std::string advice_on_resolution(const Camera& camera, int image_width, int image_height) {
  const std::string advice = "use the camera file of this resolution";
  const bool is_one_shape = camera.width > 0 && static_cast<std::int64_t>(image_width) * camera.height ==
                                                    static_cast<std::int64_t>(image_height) * camera.width;
  const bool is_turned = image_width == camera.height && image_height == camera.width;
  if (is_turned)
    return advice +
           "; width and height are exchanged: pictures are turned upright as the rotation tag of a video, or "
           "the "
           "EXIF orientation of a picture, says, and the camera file must be that of the upright picture";
  if (!is_one_shape) return advice;
  const double scale = static_cast<double>(image_width) / camera.width;
  const auto scaled = [&](double center_px) { return scale * (center_px + 0.5) - 0.5; };  // (0, 0): a centre
  const Pinhole& lens = camera.model.pinhole();
  return fmt::format(
      "{}; if the pictures were scaled by {:.4g}, and not cropped, that is this one with intrinsics: "
      "[{:.8g}, {:.8g}, {:.8g}, {:.8g}] and resolution: [{}, {}]",
      advice, scale, scale * lens.fx, scale * lens.fy, scaled(lens.cx), scaled(lens.cy), image_width,
      image_height);
}

}  // namespace apriltrack
