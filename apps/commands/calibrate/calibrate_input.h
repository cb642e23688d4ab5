#pragma once

#include <map>
#include <string>
#include <vector>

#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detection.h"
#include "apriltrack/detect/detector.h"
#include "apriltrack/detect/left_out_tags.h"
#include "apriltrack/source/frame_source.h"
#include "cli/console.h"
#include "files/frame_loop.h"
#include "files/recordings.h"

namespace apriltrack::app {

/// Why there is no map.
inline constexpr const char* kInterruptedAtOnce =
    "interrupted before the first frame of the map was read: no map was written";

/// Everything that was found in all inputs.
struct Sightings {
  std::vector<FrameDetections> frames;  ///< In the order of time, by one clock (SessionClocks).
  FrameCounts counts;                   ///< Of all recordings; no range.
  std::map<std::string, ValueRange>
      value_ranges;  ///< By name of the recording, of those with 16-bit pictures.
  LeftOutTags left_out;
  /// What is wrong with pictures in which hardly a tag is read.
  std::vector<std::string> odd_pictures;
  std::vector<std::string> warnings;  ///< What to know of their times and, of detection files, corners.
  /// The cameras of which corners at odd places are among these: calibrate_map, which warns of them too,
  /// knows no file and no line.
  std::set<std::string> cameras_told;
};

/// Detects in every frame of every recording. with_patches: pictures of the tags are kept, of films with
/// thousands of frames of some hundred only. Throws Error(kIo) when one cannot be read at all,
/// Error(kInvalidInput) when images do not fit the camera, or as SessionClocks does.
Sightings detect_in(const std::vector<Recording>& recordings, const CameraRig& rig,
                    const DetectorOptions& detector, const SourceOptions& source_options, int num_threads,
                    bool with_patches, const Console& console);

/// Reads detection files with read_rig_detections. camera_name: only this camera's rows; empty: all. Throws
/// as SessionClocks, check_cameras_and_tags and check_picture_sizes do.
Sightings read_sightings(const std::vector<std::string>& paths, const CameraRig& rig,
                         const std::string& camera_name);

}  // namespace apriltrack::app
