#include <fmt/format.h>

#include <algorithm>

#include "../camera_fields.h"
#include "apriltrack/base/error.h"
#include "apriltrack/io/atomic_file.h"
#include "writers.h"

namespace apriltrack {
namespace {

/// What a format that is written has room for, beside the lens.
struct Room {
  bool resolution = false;
  bool needs_resolution = false;
  bool light_and_rows = false;  ///< Response, exposure and line delay.
  bool extrinsics = false;      ///< Of each camera that it holds.
  bool names = false;
  bool rigs = false;
};

Room room_of(CameraFormat format) {
  switch (format) {
    case CameraFormat::kKalibr:
      return {true, true, true, true, true, true};
    case CameraFormat::kRosCameraInfo:
      return {.resolution = true, .needs_resolution = true, .names = true};
    case CameraFormat::kOpenCv:
      return {.resolution = true};
    case CameraFormat::kPhotonVision:
      return {.resolution = true, .needs_resolution = true};
    case CameraFormat::kMrcal:
      return {.resolution = true, .needs_resolution = true, .extrinsics = true};
    case CameraFormat::kColmap:
      return {.resolution = true, .needs_resolution = true, .rigs = true};
    default:
      return {};
  }
}

/// The cameras of the rig that a file gets: their places in it.
std::vector<std::size_t> chosen_cameras(const CameraRig& rig, CameraFormat format, const std::string& only) {
  std::vector<std::size_t> chosen;
  const std::string first = rig.cameras.empty() ? "" : rig.cameras.front().name;
  const std::string name = !only.empty() ? rig.find(only).name : room_of(format).rigs ? "" : first;
  for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
    if (name.empty() || rig.cameras[i].name == name) chosen.push_back(i);
  }
  return chosen;
}

std::vector<std::string> names_of(const CameraRig& rig, const std::vector<std::size_t>& but) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
    if (std::find(but.begin(), but.end(), i) == but.end()) names.push_back(rig.cameras[i].name);
  }
  return names;
}

/// Relative to the first camera; nullopt where the file does not give it.
std::optional<Pose> T_camera_first(const CameraRig& rig, std::size_t index) {
  Pose T_camera_first;
  for (std::size_t i = 1; i <= index; ++i) {
    if (!rig.cameras[i].T_this_previous) return std::nullopt;
    T_camera_first = *rig.cameras[i].T_this_previous * T_camera_first;
  }
  return T_camera_first;
}

/// ROS's calibrator states five coefficients, of which the last is often 0. Kalibr reads four: the lens is
/// the same.
Camera without_last_zero(Camera camera) {
  std::vector<double> coefficients = coefficients_of(camera.model);
  constexpr std::size_t kOfRos = 5;
  if (coefficients.size() != kOfRos || coefficients.back() != 0.0) return camera;
  coefficients.pop_back();
  camera.model = CameraModel(camera.model.pinhole(), RadtanDistortion(coefficients));
  return camera;
}

/// ethz-asl/kalibr: aslam_cv RadialTangentialDistortion has k1 k2 p1 p2 alone.
void note_lens_beyond_kalibr(const Camera& camera, std::vector<ConversionLoss>& lost) {
  constexpr std::size_t kOfKalibr = 4;
  const std::size_t count = coefficients_of(without_last_zero(camera).model).size();
  if (count <= kOfKalibr) return;
  lost.push_back({.kind = LossKind::kUnreadLens,
                  .how = LossHow::kConverted,
                  .which = {camera.name},
                  .numbers = {static_cast<double>(count), static_cast<double>(kOfKalibr)}});
}

/// `index` of the rig is at `place` of the file.
void note_losses(const CameraRig& rig, std::size_t index, std::size_t place, CameraFormat format,
                 std::vector<ConversionLoss>& lost) {
  const Camera& camera = rig.cameras[index];
  const Room room = room_of(format);
  const auto note = [&](ConversionLoss loss) {
    loss.which = {camera.name};
    lost.push_back(std::move(loss));
  };
  if (!room.resolution && camera.width > 0)
    note({.kind = LossKind::kResolution, .value = fmt::format("{} x {}", camera.width, camera.height)});
  if (!room.light_and_rows && camera.response_origin != ResponseOrigin::kAssumed)
    note({.kind = LossKind::kResponse, .value = camera.response.name()});
  if (!room.light_and_rows && camera.exposure_s)
    note({.kind = LossKind::kExposure, .numbers = {*camera.exposure_s}});
  if (!room.light_and_rows && camera.line_delay_s != 0.0)
    note({.kind = LossKind::kLineDelay, .numbers = {camera.line_delay_s}});
  if (const std::string name = fmt::format("cam{}", place); !room.names && camera.name != name)
    note({.kind = LossKind::kNames, .how = LossHow::kConverted, .value = name});
  if (format == CameraFormat::kKalibr) note_lens_beyond_kalibr(camera, lost);
  // Kalibr's place is relative to the camera before, which is not there where one camera is taken of a rig;
  // mrcal's is relative to the first.
  const bool keeps_place =
      room.extrinsics &&
      (format == CameraFormat::kKalibr ? place == index : T_camera_first(rig, index).has_value());
  if (!keeps_place && camera.T_this_previous) note({.kind = LossKind::kExtrinsics, .value = "T_cn_cnm1"});
}

std::string text_of(const CameraRig& rig, const std::vector<std::size_t>& chosen, CameraFormat format) {
  const Camera& camera = rig.cameras[chosen.front()];
  switch (format) {
    case CameraFormat::kRosCameraInfo:
      return ros_camera_info_text(camera);
    case CameraFormat::kOpenCv:
      return opencv_text(camera);
    case CameraFormat::kWpilib:
      return wpilib_text(camera);
    case CameraFormat::kPhotonVision:
      return photonvision_text(camera);
    case CameraFormat::kMrcal:
      return mrcal_text(camera, T_camera_first(rig, chosen.front()).value_or(Pose()));
    default: {
      std::vector<Camera> cameras;
      for (const std::size_t index : chosen) cameras.push_back(rig.cameras[index]);
      return colmap_text(cameras);
    }
  }
}

void check_can_be_written(CameraFormat format, const std::filesystem::path& path) {
  if (info_of(format).is_written) return;
  std::string names;
  for (const CameraFormatInfo& info : camera_formats()) {
    if (info.is_written) names += fmt::format("{}{}", names.empty() ? "" : ", ", info.name);
  }
  throw invalid_input(path.string(),
                      fmt::format("{} is read, not written; written are {}", info_of(format).title, names));
}

/// Our own format, of the cameras that were chosen.
void write_camchain(const std::filesystem::path& path, const CameraRig& rig,
                    const std::vector<std::size_t>& chosen) {
  CameraRig part;
  for (const std::size_t index : chosen) part.cameras.push_back(without_last_zero(rig.cameras[index]));
  part.cameras.front().T_this_previous.reset();
  write_cameras(path, part);
}

}  // namespace

std::vector<ConversionLoss> losses_of_writing(const CameraRig& rig, CameraFormat format,
                                              const std::string& only) {
  std::vector<ConversionLoss> lost;
  const std::vector<std::size_t> chosen = chosen_cameras(rig, format, only);
  for (std::size_t place = 0; place < chosen.size(); ++place)
    note_losses(rig, chosen[place], place, format, lost);
  std::vector<std::string> others = names_of(rig, chosen);
  if (!others.empty()) lost.push_back({.kind = LossKind::kFurtherCameras, .which = std::move(others)});
  return lost;
}

std::vector<ConversionLoss> write_cameras_as(const std::filesystem::path& path, const CameraRig& rig,
                                             CameraFormat format, const std::string& only) {
  check_can_be_written(format, path);
  if (rig.cameras.empty()) throw invalid_input(path.string(), "there is no camera to write");
  const std::vector<std::size_t> chosen = chosen_cameras(rig, format, only);
  for (const std::size_t index : chosen) {
    if (room_of(format).needs_resolution) require_resolution(rig.cameras[index], path);
  }
  if (format == CameraFormat::kKalibr) {
    write_camchain(path, rig, chosen);
    return losses_of_writing(rig, format, only);
  }
  try {
    write_file_atomically(path, text_of(rig, chosen, format));
  } catch (const Error& error) {
    if (!error.where().empty()) throw;
    throw Error(error.kind(), path.string(), error.cause());
  }
  return losses_of_writing(rig, format, only);
}

}  // namespace apriltrack
