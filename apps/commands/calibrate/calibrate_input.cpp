#include "calibrate_input.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "apriltrack/base/error.h"
#include "apriltrack/detect/estimate_response.h"
#include "apriltrack/detect/odd_picture_watch.h"
#include "apriltrack/detect/patch_keeper.h"
#include "apriltrack/source/session_clocks.h"
#include "files/frame_loop.h"
#include "files/frame_options.h"
#include "files/inputs.h"
#include "files/rig_detections.h"

namespace apriltrack::app {
namespace {

void bring_to_one_clock(SessionClocks& sessions, Sightings& all) {
  SessionClocks::Aligned result = sessions.align();
  all.frames = std::move(result.frames);
  if (result.warning) all.warnings.push_back(*result.warning);
}

}  // namespace

Sightings detect_in(const std::vector<Recording>& recordings, const CameraRig& rig,
                    const DetectorOptions& detector, const SourceOptions& source_options, int num_threads,
                    bool with_patches, const Console& console) {
  Sightings all;
  SessionClocks sessions;
  for (const Recording& recording : recordings) {
    const Camera& camera = rig.find(recording.camera);
    if (all.counts.is_interrupted) {  // what was to come tells still which sessions there are
      sessions.add(recording.name(), {camera.name}, {});
      continue;
    }
    DetectFramesOptions options{detector, &camera, num_threads, source_options.skip,
                                "detect " + recording.name()};
    options.detector->response = camera.response;
    options.detector->rival_response = rival_response(camera.response, camera.response_origin);
    options.detector->camera_model = camera.model;
    SourceOptions source_of_camera = source_options;
    source_of_camera.log = console.log();
    source_of_camera.topic = recording.topic;
    set_shutter(source_of_camera, camera);
    if (recording.is_named) source_of_camera.camera_name = recording.camera;
    const std::unique_ptr<FrameSource> source = open_source(recording.input, source_of_camera);
    std::vector<FrameDetections> frames;
    PatchKeeper keeper;
    OddPictureWatch watch;
    const FrameCounts counts = detect_frames(*source, options, console, [&](DetectedFrame frame) {
      if (!frame.source.is_readable()) return;
      watch.add(frame.source.pixels.view(), frame.detections);
      all.left_out.add(frame.left_out);
      frames.push_back({frame.source.timestamp, camera.name, std::move(frame.detections)});
      frames.back().exposure_s = frame.source.exposure_s;
      if (with_patches) keeper.keep(frame.source.frame().image, frames.back());
    });
    sessions.add(recording.name(), {camera.name}, std::move(frames));
    if (const auto odd = is_interrupted() ? std::nullopt : watch.message(*options.detector))
      all.odd_pictures.push_back(recording.name() + ": " + *odd);
    if (counts.value_range) all.value_ranges.emplace(recording.name(), *counts.value_range);
    all.counts.readable += counts.readable;
    all.counts.unreadable += counts.unreadable;
    all.counts.blank += counts.blank;
    all.counts.copies += counts.copies;
    all.counts.is_interrupted = counts.is_interrupted;
  }
  bring_to_one_clock(sessions, all);
  return all;
}

Sightings read_sightings(const std::vector<std::string>& paths, const CameraRig& rig,
                         const std::string& camera_name) {
  if (!camera_name.empty()) camera_named(rig, camera_name, "--camera-name");
  Sightings all;
  SessionClocks sessions;
  for (const std::string& path : paths) {
    std::vector<FrameDetections> frames = read_rig_detections(path, rig);
    if (!camera_name.empty())
      std::erase_if(frames, [&](const FrameDetections& frame) { return frame.camera != camera_name; });
    const std::vector<std::string> cameras = camera_names(frames);
    check_cameras_and_tags(path, rig, frames);
    for (const std::string& camera : cameras) {
      std::vector<std::string> odd_corners = check_corner_places(path, {{rig.find(camera)}}, frames);
      if (!odd_corners.empty()) all.cameras_told.insert(camera);
      std::ranges::move(odd_corners, std::back_inserter(all.warnings));
    }
    sessions.add(path, {cameras.begin(), cameras.end()}, std::move(frames));
  }
  bring_to_one_clock(sessions, all);
  all.counts.readable = all.frames.size();
  if (!camera_name.empty() && all.frames.empty())
    throw no_result("calibrate", fmt::format("the detection files have no rows of camera {}", camera_name));
  if (all.frames.empty())
    throw no_result("calibrate", fmt::format("no rows below the header of {}: nothing was detected",
                                             fmt::join(paths, ", ")));
  return all;
}

}  // namespace apriltrack::app
