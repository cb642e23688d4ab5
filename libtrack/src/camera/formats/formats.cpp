#include <algorithm>
#include <array>

#include "apriltrack/base/check.h"
#include "apriltrack/camera/camera_formats.h"

namespace apriltrack {
namespace {

constexpr std::array<CameraFormatInfo, 14> kFormats = {{
    {CameraFormat::kKalibr, "kalibr", "Kalibr camchain YAML", true},
    {CameraFormat::kRosCameraInfo, "ros", "ROS camera_info YAML", true},
    {CameraFormat::kRosIni, "ros-ini", "ROS camera .ini", false},
    {CameraFormat::kOpenCv, "opencv", "OpenCV FileStorage", true},
    {CameraFormat::kWpilib, "wpilib", "WPILib JSON", true},
    {CameraFormat::kPhotonVision, "photonvision", "PhotonVision JSON", true},
    {CameraFormat::kMrcal, "mrcal", "mrcal .cameramodel", true},
    {CameraFormat::kColmap, "colmap", "COLMAP cameras.txt", true},
    {CameraFormat::kEuroc, "euroc", "EuRoC sensor.yaml", false},
    {CameraFormat::kNerfstudio, "nerfstudio", "nerfstudio transforms.json", false},
    {CameraFormat::kOpenImuCameraCalibrator, "openicc", "OpenImuCameraCalibrator JSON", false},
    {CameraFormat::kBasalt, "basalt", "Basalt calibration.json", false},
    {CameraFormat::kVins, "vins", "VINS-Fusion camera YAML", false},
    {CameraFormat::kOrbSlam, "orbslam3", "ORB-SLAM3 settings YAML", false},
}};

}  // namespace

std::span<const CameraFormatInfo> camera_formats() {
  return kFormats;
}

const CameraFormatInfo& info_of(CameraFormat format) {
  const auto found = std::ranges::find(kFormats, format, &CameraFormatInfo::format);
  APRILTRACK_CHECK(found != kFormats.end(), "no such format");
  return *found;
}

std::optional<CameraFormat> camera_format_named(std::string_view name) {
  const auto found = std::ranges::find(kFormats, name, &CameraFormatInfo::name);
  return found == kFormats.end() ? std::nullopt : std::optional(found->format);
}

std::optional<CameraFormat> camera_format_of_ending(const std::filesystem::path& path) {
  const std::string ending = path.extension().string();
  if (ending == ".yaml" || ending == ".yml") return CameraFormat::kKalibr;
  if (ending == ".cameramodel") return CameraFormat::kMrcal;
  if (ending == ".txt") return CameraFormat::kColmap;
  return std::nullopt;
}

std::string_view name_of(CameraLoss loss) {
  switch (loss) {
    case CameraLoss::kResolution:
      return "resolution";
    case CameraLoss::kResponse:
      return "response";
    case CameraLoss::kExposure:
      return "exposure";
    case CameraLoss::kLineDelay:
      return "line_delay";
    case CameraLoss::kExtrinsics:
      return "extrinsics";
    case CameraLoss::kNames:
      return "names";
    case CameraLoss::kFurtherCameras:
      return "further_cameras";
    case CameraLoss::kSkew:
      return "skew";
    case CameraLoss::kLensTerms:
      return "lens_terms";
    case CameraLoss::kUnreadLens:
      return "unread_lens";
  }
  return "resolution";
}

}  // namespace apriltrack
