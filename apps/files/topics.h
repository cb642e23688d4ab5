#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apriltrack/camera/camera.h"
#include "apriltrack/source/frame_source.h"
#include "cli/console.h"
#include "recordings.h"

namespace CLI {
class App;
}

namespace apriltrack::app {

/// Adds --topic, which may be given once for each camera, and --stamp-is.
void add_bag_options(CLI::App& command, std::vector<std::string>& topics, StampIs& stamp_is);

/// Gives recordings that are bags their topics. topics: as --topic has them, "NAME" for all or "cam0=NAME".
///
/// A bag whose camera the user did not name becomes a recording of each camera that a topic is named for or,
/// where none is and the rig has several, of each whose `rostopic` has pictures in it. One that no topic is
/// named for gets its camera's `rostopic` where that is one of several topics with pictures; the console
/// hears of it, and is warned of a topic that the camera file gives to another camera. rig: of the camera
/// file; nullptr where there is none.
///
/// Throws Error(kInvalidInput) when topics are given and no recording is a bag, or one is for a camera that
/// no bag is of, or that the rig does not have; as open_bag() does.
std::vector<Recording> with_topics(std::vector<Recording> recordings, const std::vector<std::string>& topics,
                                   const CameraRig* rig, const std::filesystem::path& camera_file,
                                   const Console& console);

/// The same for the one recording of commands that take one camera. camera_file: empty where there is none.
std::string topic_of(const std::string& input, const std::vector<std::string>& topics,
                     const std::string& camera, const std::filesystem::path& camera_file,
                     const Console& console);

/// The camera of a recording: as --camera-name names it, or --topic CAMERA=NAME, or, of a bag, the one whose
/// `rostopic` is the topic that is read. Empty where none of these tells.
std::string camera_name_of(const std::string& input, const std::vector<std::string>& topics,
                           const std::string& camera_name, const std::filesystem::path& camera_file,
                           const Console& console);

/// What --topic says before a camera is known: that for all, or the only one there is; else empty.
std::string topic_without_camera(const std::vector<std::string>& topics);

}  // namespace apriltrack::app
