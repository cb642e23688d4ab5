#include <fmt/format.h>

#include "apriltrack/geometry/rotation.h"
#include "writers.h"

namespace apriltrack {

// dkogan/mrcal: mrcal/cameramodel.py. The place is rt: Rodrigues' rotation vector, then the translation, of
// the transform from the reference to the camera.
std::string mrcal_text(const Camera& camera, const Pose& T_camera_reference) {
  const bool is_pinhole = std::holds_alternative<NoDistortion>(camera.model.distortion());
  std::vector<double> coefficients = radtan_coefficients(camera, "mrcal");  // refuses a fisheye
  coefficients = coefficients_of(camera.model);                             // 4 stay 4
  const Pinhole& lens = camera.model.pinhole();
  std::vector<double> intrinsics = {lens.fx, lens.fy, lens.cx, lens.cy};
  intrinsics.insert(intrinsics.end(), coefficients.begin(), coefficients.end());
  const Eigen::Vector3d r = rotation_log(T_camera_reference.rotation());
  const Eigen::Vector3d& t = T_camera_reference.translation();
  const std::string model = is_pinhole ? "PINHOLE" : fmt::format("OPENCV{}", coefficients.size());
  return fmt::format(
      "{{\n    'lensmodel':  'LENSMODEL_{}',\n\n"
      "    # fx, fy, cx, cy, then the distortion in OpenCV's order\n    'intrinsics': [ {} ],\n\n"
      "    # rt: from the reference to the camera\n    'extrinsics': [ {} ],\n\n"
      "    'imagersize': [ {}, {} ],\n}}\n",
      model, joined(intrinsics), joined({r.x(), r.y(), r.z(), t.x(), t.y(), t.z()}), camera.width,
      camera.height);
}

}  // namespace apriltrack
