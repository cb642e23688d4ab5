#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apriltrack/base/log.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/io/conversion_loss.h"
#include "apriltrack/io/name_ending.h"

namespace apriltrack {

/// Whose camera file it is. What each can hold, and where its pixel (0, 0) lies: docs/file_formats.md.
enum class CameraFormat {
  kKalibr,                   ///< Kalibr's camchain with our additions: what write_cameras() writes.
  kRosCameraInfo,            ///< ROS camera_info as YAML: of the calibration tool, or echoed from a topic.
  kRosIni,                   ///< The older .ini file of ROS.
  kOpenCv,                   ///< cv::FileStorage as YAML or JSON.
  kWpilib,                   ///< WPILib's JSON (WPIcal).
  kPhotonVision,             ///< PhotonVision's JSON.
  kMrcal,                    ///< mrcal's .cameramodel.
  kColmap,                   ///< COLMAP's cameras.txt.
  kEuroc,                    ///< EuRoC's sensor.yaml.
  kNerfstudio,               ///< nerfstudio's transforms.json.
  kOpenImuCameraCalibrator,  ///< OpenImuCameraCalibrator's JSON (GoPro).
  kBasalt,                   ///< Basalt's calibration.json.
  kVins,                     ///< The YAML of a camera of VINS-Fusion and VINS-Mono (camodocal).
  kOrbSlam,                  ///< Settings of ORB-SLAM2 and ORB-SLAM3.
};

struct CameraFormatInfo {
  CameraFormat format;
  std::string_view name;   ///< On the command line: "ros".
  std::string_view title;  ///< In sentences: "ROS camera_info YAML".
  bool is_written;
  std::span<const NameEnding> endings = {};
};

/// All formats; every one is read.
std::span<const CameraFormatInfo> camera_formats();
const CameraFormatInfo& info_of(CameraFormat format);
/// The format of a name, if it is one.
std::optional<CameraFormat> camera_format_named(std::string_view name);
/// What a file to write is by the ending of its name; nullopt where that does not tell (.json).
std::optional<CameraFormat> camera_format_of_ending(const std::filesystem::path& path);

/// A camera file as it was read.
struct CameraFile {
  CameraFormat format = CameraFormat::kKalibr;
  CameraRig rig;
  std::vector<ConversionLoss> lost;  ///< What the file says and Camera does not hold.
};

/// The sentence that every reader logs of a loss that moves points of the picture (kSkew, kLensTerms): file,
/// line, key, how much, and the way out. Empty of all others.
std::string sentence_of_moved_points(const ConversionLoss& loss);

/// What becomes of a lens with OpenCV's thin prism or tilted sensor, which ours have not.
enum class BeyondOurLenses {
  kRefuse,  ///< Error(kInvalidInput).
  kFit,  ///< The nearest of radtan with eight coefficients over the picture is taken, where that is off by no
         ///< more than 0.5 px; how far it is off is told.
};

/// As read_cameras(), which tells neither the format nor what was passed over. `response: auto` is passed
/// over, too.
CameraFile read_camera_file(const std::filesystem::path& path, const LogSink& log = silent_log(),
                            BeyondOurLenses beyond = BeyondOurLenses::kRefuse);

/// What write_cameras_as() would leave out.
std::vector<ConversionLoss> losses_of_writing(const CameraRig& rig, CameraFormat format,
                                              const std::string& only = {});

/// Writes cameras in any format that is written, to the last digit of every number.  only: the name of the
/// one camera to write; empty: all of the rig, or the first where the format is of one camera. mrcal's file
/// has its place relative to the rig's first camera. Returns what the format cannot hold. Throws
/// Error(kInvalidInput) where the format is only read, needs a resolution that the camera has not, or has no
/// such lens model, or where no camera has the name; Error(kIo). Nothing is written then.
std::vector<ConversionLoss> write_cameras_as(const std::filesystem::path& path, const CameraRig& rig,
                                             CameraFormat format, const std::string& only = {});

}  // namespace apriltrack
