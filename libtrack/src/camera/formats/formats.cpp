#include "formats.h"

#include <algorithm>
#include <array>

#include "apriltrack/base/check.h"

namespace apriltrack {
namespace {

CameraRig read_kalibr(const CameraText& file, CameraReading& reading) {
  return read_kalibr_camchain(*file.root, reading.folder, reading.to_estimate, reading.lost);
}

constexpr NameEnding kOwnYaml[] = {{".yaml", true}, {".yml", true}};
constexpr NameEnding kYaml[] = {{".yaml"}, {".yml"}};
constexpr NameEnding kJson[] = {{".json"}};
constexpr NameEnding kCameraModel[] = {{".cameramodel", true}};
constexpr NameEnding kText[] = {{".txt", true, true}};

// In the order in which they are told, and recognised.
constexpr std::array<CameraFormatCode, 14> kFormats = {{
    {{CameraFormat::kKalibr, "kalibr", "Kalibr camchain YAML", true, kOwnYaml},
     "'cam0' (Kalibr camchain)",
     is_kalibr_camchain,
     read_kalibr},
    {{CameraFormat::kRosCameraInfo, "ros", "ROS camera_info YAML", true, kYaml},
     "'camera_matrix' or 'K' (OpenCV FileStorage, ROS camera_info, WPILib JSON)",
     is_ros_camera_info,
     read_matrix_camera},
    {{CameraFormat::kRosIni, "ros-ini", "ROS camera .ini", false}, "", is_ros_ini, read_ros_ini, true},
    {{CameraFormat::kOpenCv, "opencv", "OpenCV FileStorage", true, kYaml}, "", is_opencv, read_matrix_camera},
    {{CameraFormat::kWpilib, "wpilib", "WPILib JSON", true, kJson}, "", is_wpilib, read_matrix_camera},
    {{CameraFormat::kPhotonVision, "photonvision", "PhotonVision JSON", true, kJson},
     "'cameraIntrinsics' (PhotonVision JSON)",
     is_photonvision,
     read_matrix_camera},
    {{CameraFormat::kMrcal, "mrcal", "mrcal .cameramodel", true, kCameraModel},
     "",
     is_mrcal,
     read_mrcal,
     true},
    {{CameraFormat::kColmap, "colmap", "COLMAP cameras.txt", true, kText}, "", is_colmap, read_colmap, true},
    {{CameraFormat::kOpenImuCameraCalibrator, "openicc", "OpenImuCameraCalibrator JSON", false},
     "'intrinsic_type' (OpenImuCameraCalibrator)",
     is_openicc,
     read_openicc},
    {{CameraFormat::kEuroc, "euroc", "EuRoC sensor.yaml", false},
     "'intrinsics' with 'distortion_model' (EuRoC sensor.yaml)",
     is_euroc_sensor,
     read_euroc_sensor},
    {{CameraFormat::kBasalt, "basalt", "Basalt calibration.json", false},
     "'value0' (Basalt)",
     is_basalt,
     read_basalt},
    {{CameraFormat::kVins, "vins", "VINS-Fusion camera YAML", false},
     "'model_type' (VINS-Fusion)",
     is_vins,
     read_vins},
    {{CameraFormat::kOrbSlam, "orbslam3", "ORB-SLAM3 settings YAML", false},
     "'Camera.fx' or 'Camera1.fx' (ORB-SLAM3)",
     is_orbslam,
     read_orbslam},
    {{CameraFormat::kNerfstudio, "nerfstudio", "nerfstudio transforms.json", false},
     "'fl_x' (nerfstudio)",
     is_nerfstudio,
     read_nerfstudio},
}};

constexpr auto kInfos = [] {
  std::array<CameraFormatInfo, kFormats.size()> infos{};
  std::ranges::transform(kFormats, infos.begin(), &CameraFormatCode::info);
  return infos;
}();

std::optional<CameraFormat> format_of(auto found) {
  return found == kInfos.end() ? std::nullopt : std::optional(found->format);
}

}  // namespace

std::span<const CameraFormatCode> camera_format_codes() {
  return kFormats;
}

std::span<const CameraFormatInfo> camera_formats() {
  return kInfos;
}

const CameraFormatInfo& info_of(CameraFormat format) {
  const auto found = std::ranges::find(kInfos, format, &CameraFormatInfo::format);
  APRILTRACK_CHECK(found != kInfos.end(), "no such format");
  return *found;
}

std::optional<CameraFormat> camera_format_named(std::string_view name) {
  return format_of(std::ranges::find(kInfos, name, &CameraFormatInfo::name));
}

std::optional<CameraFormat> camera_format_of_ending(const std::filesystem::path& path) {
  return format_of_ending(kInfos, path);
}

void note_name(const std::string& name, std::vector<ConversionLoss>& lost) {
  if (!name.empty() && name != "cam0")
    lost.push_back({.kind = LossKind::kNames, .how = LossHow::kConverted, .which = {name}, .value = "cam0"});
}

void note_place(const YamlNode& root, std::string_view key, const std::string& camera,
                std::vector<ConversionLoss>& lost) {
  if (root.find(key))
    lost.push_back({.kind = LossKind::kExtrinsics, .which = {camera}, .value = std::string(key)});
}

std::string sentence_of_moved_points(const ConversionLoss& loss) {
  if (loss.kind == LossKind::kSkew) return sentence_of_skew(loss);
  return loss.kind == LossKind::kLensTerms ? sentence_of_lens_terms(loss) : "";
}

}  // namespace apriltrack
