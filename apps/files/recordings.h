#pragma once

#include <string>
#include <vector>

#include "apriltrack/camera/camera.h"

namespace apriltrack::app {

/// One INPUT and the camera that filmed it.
struct Recording {
  std::string camera;
  std::string input;
  bool is_named = false;   ///< By the user: of a EuRoC recording with several, too, it is this camera.
  std::string topic = {};  ///< Of a bag; empty: the only one with pictures.

  /// What messages call it.
  std::string name() const { return topic.empty() ? input : input + " " + topic; }
};

/// `cam1=PATH` names the camera. A path in which an = merely occurs has none: something of that very name is
/// there, or the = is not in its first part. Throws Error(kInvalidInput) when nothing follows the =.
Recording split_input(const std::string& input);

/// A PATH that names none is camera_name's, or the first camera's where that is empty.
std::vector<Recording> parse_recordings(const std::vector<std::string>& inputs, const CameraRig& rig,
                                        const std::string& camera_name);

}  // namespace apriltrack::app
