#pragma once

#include <string>
#include <vector>

#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detection.h"

namespace apriltrack::app {

/// Reads a detection file that was made with the cameras of `rig`. Where both have one camera only, it is
/// the same one, whatever the file calls it; where the rig has several, the file's name says which one, and
/// to pass it over would give corners another camera's lens. Throws as read_detections_csv does, and
/// Error(kInvalidInput) where the corners of all tags are in another order than ours.
std::vector<FrameDetections> read_rig_detections(const std::string& path, const CameraRig& rig);

/// Throws Error(kInvalidInput) with file and line unless each camera is one of `rig`, and each tag one that
/// is printed: no map can hold another.
void check_cameras_and_tags(const std::string& path, const CameraRig& rig,
                            const std::vector<FrameDetections>& frames);

/// check_picture_sizes of the frames of `path`, with file and line.
std::vector<std::string> check_corner_places(const std::string& path, const CameraRig& rig,
                                             const std::vector<FrameDetections>& frames);

/// Names in the order of the alphabet, each once.
std::vector<std::string> camera_names(const std::vector<FrameDetections>& frames);

}  // namespace apriltrack::app
