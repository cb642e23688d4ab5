#include "formats.h"

#include <algorithm>
#include <array>

#include "apriltrack/base/check.h"

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

std::string sentence_of_moved_points(const ConversionLoss& loss) {
  if (loss.kind == LossKind::kSkew) return sentence_of_skew(loss);
  return loss.kind == LossKind::kLensTerms ? sentence_of_lens_terms(loss) : "";
}

}  // namespace apriltrack
