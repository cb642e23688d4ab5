#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apriltrack/camera/auto_response.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/camera/camera_formats.h"
#include "cli/console.h"

namespace apriltrack::app {

/// The file that an option names, else the sequence folder's own; throws Error(kInvalidInput) where there is
/// neither. option: "--map"; name: "map.yaml".
std::filesystem::path file_or_own(const std::string& given, const std::optional<std::filesystem::path>& own,
                                  std::string_view option, std::string_view name);

/// What a run with this --camera and these INPUTs reads for its cameras: the file given, and the response
/// tables that it names, or the sequence folders' own files where none is given. For check_output(), which
/// knows these own files themselves.
std::vector<std::string> camera_inputs(const std::string& given, const std::vector<std::string>& inputs);

/// Throws Error(kInvalidInput) that lists the names there are. where: the option, the line or the file whose
/// camera is looked for, which the message begins with.
const Camera& camera_named(const CameraRig& rig, const std::string& name, std::string_view where);

/// Where the camera of an INPUT is told.
struct CameraSource {
  std::filesystem::path path;  ///< A file, or a bag, for read_rig().
  std::string called = {};     ///< What its camera is called, where the file itself does not name it.
};

/// The camera called `name`, or the file's first where `name` is empty; odd values are told to the console.
/// may_have_auto_response: `response: auto` is taken for sRGB, and not refused.
/// Throws as read_cameras and camera_named do.
Camera read_camera(const std::filesystem::path& path, const std::string& name, const Console& console,
                   bool may_have_auto_response = false);
/// The same of a file that camera_source() found.
Camera read_camera(const CameraSource& source, const std::string& name, const Console& console);

/// The file of the camera that --camera names, else what the INPUT itself brings: a sequence folder's
/// camera.yaml, a bag, or sensor.yaml of the camera of a EuRoC recording that `camera_name` says (empty:
/// cam0), and that is its name then; nullopt where there is none of these.
std::optional<CameraSource> camera_source(const std::string& given, const std::string& input,
                                          const std::string& camera_name);

/// Users who gave no --camera hear of a EuRoC recording's own.
void tell_of_own_camera(const CameraSource& source, const Console& console);

/// What a missing camera is told by.
inline constexpr std::string_view kNoOwnCamera =
    "is required: the input is no sequence folder with a camera.yaml of its own, no EuRoC recording with a "
    "sensor.yaml, and no bag";

/// Cameras of a file, or the one that a bag describes (bag_camera()), whose response is then not known.
/// topic: of the bag's pictures; empty: the only one. Throws as read_cameras_to_estimate() and bag_camera()
/// do, and Error(kInvalidInput) where the bag describes none.
UnestimatedRig read_rig(const CameraSource& source, const std::string& topic, const Console& console);

/// A camera file of any format, or the camera that a bag describes beside its pictures. topic: of these;
/// empty: the only one there is, and of a file. Throws as read_camera_file() and read_rig() do.
CameraFile read_camera_input(const std::string& input, const std::string& topic, const Console& console,
                             BeyondOurLenses beyond = BeyondOurLenses::kRefuse);

/// A camera file may leave out the resolution (WPILib's do): then that of the first readable image holds.
/// input and topic: as for open_source; a camera whose resolution is known is not compared with it.
Camera with_resolution_of_images(Camera camera, const std::string& input, const std::string& topic = "");

/// Throws Error(kInvalidInput) for standard input and FIFOs, where pictures are looked at more than once.
void refuse_pipe(const std::string& input);

/// Throws Error(kIo) when there is no such file or folder: before its camera is missed. Patterns and live
/// cameras are left to open_source.
void check_input(const std::string& input);

}  // namespace apriltrack::app
