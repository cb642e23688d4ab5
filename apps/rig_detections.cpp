#include "rig_detections.h"

#include <set>

#include "apriltrack/detect/detections_csv.h"

namespace apriltrack::app {

std::vector<FrameDetections> read_rig_detections(const std::string& path, const CameraRig& rig) {
  std::vector<FrameDetections> frames = read_detections_csv(path);
  if (rig.cameras.size() == 1 && camera_names(frames).size() == 1)
    for (FrameDetections& frame : frames) frame.camera = rig.cameras.front().name;
  return frames;
}

std::vector<std::string> camera_names(const std::vector<FrameDetections>& frames) {
  std::set<std::string> names;
  for (const FrameDetections& frame : frames) names.insert(frame.camera);
  return {names.begin(), names.end()};
}

}  // namespace apriltrack::app
