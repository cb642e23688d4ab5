#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apriltrack/base/log.h"
#include "apriltrack/camera/camera_model.h"
#include "apriltrack/geometry/pose.h"
#include "apriltrack/image/response.h"

namespace apriltrack {

/// Whence a camera's response is known.
enum class ResponseOrigin {
  kStated,     ///< By the camera file, or by whoever made the camera.
  kEstimated,  ///< By pictures of tags (detect/estimate_response.h).
  kAssumed,    ///< Not at all: sRGB is taken for it. Corners may err by some tenths of a pixel.
};

/// One camera as its file describes it.
///
/// It has no default constructor, since no lens is a sound guess: a member that gets its camera later is a
/// `std::optional<Camera>`.
struct Camera {
  /// What messages, detections and NAME=PATH call it: cam0, cam1, ... or its `label` in the file.
  std::string name = "cam0";
  CameraModel model;
  int width = 0;  ///< Pixels; 0 when the file does not say (some WPILib files): any image fits.
  int height = 0;
  std::optional<double> exposure_s = std::nullopt;
  double line_delay_s = 0.0;  ///< Per row; 0 = global shutter.
  ResponseCurve response = ResponseCurve::srgb();
  ResponseOrigin response_origin = ResponseOrigin::kStated;
  std::optional<Pose> T_this_previous = std::nullopt;  ///< Kalibr's T_cn_cnm1; none for the first camera.
};

/// The cameras of one file, in its order. The rig's pose is that of the first.
struct CameraRig {
  std::vector<Camera> cameras;

  /// Throws Error(kInvalidInput) that lists the names there are.
  const Camera& find(const std::string& name) const;
  /// T_camera_rig of camera `index`; throws Error(kInvalidInput) when the file gives no extrinsics for it.
  Pose T_camera_rig(std::size_t index) const;
};

/// Throws Error(kInvalidInput) that names both sizes when an image does not have the camera's resolution.
/// where: the image's file, or the recording's name and frame.
void check_resolution(const Camera& camera, int image_width, int image_height, const std::string& where);

/// What to do where pictures are of another size than the camera's: the numbers of the camera file for
/// pictures that were scaled to it, where both have one shape, and else the file of that resolution.
std::string advice_on_resolution(const Camera& camera, int image_width, int image_height);

/// Reads a camera file of any format that camera_formats.h lists: Kalibr's camchain with our additions, ROS,
/// OpenCV, WPILib, mrcal, COLMAP, ...; it is recognised by its content (docs/file_formats.md).
/// Throws Error(kIo) when the file cannot be read, Error(kInvalidInput) with file, line and key when it is
/// wrong. log: hears of what is odd but may be meant: a principal point outside the picture, a lens model
/// that ends inside it.
CameraRig read_cameras(const std::filesystem::path& path, const LogSink& log = silent_log());

/// Writes our camera.yaml (Kalibr's camchain). Reading it gives the same numbers to the last digit;
/// rotations, whose matrix Kalibr wants, come back to 1e-15. A response table goes into a file of its own
/// beside it; a response that was only assumed is left out, so that it stays unknown. A camera that is not
/// called cam0, cam1, ... by its place keeps its name as `label`. Throws Error(kIo), and Error(kInvalidInput)
/// where there is no camera, one has no resolution, or two have one name.
void write_cameras(const std::filesystem::path& path, const CameraRig& rig);

}  // namespace apriltrack
