#include "calibrate_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <map>
#include <set>

#include "apriltrack/base/error.h"
#include "apriltrack/detect/detections_csv.h"
#include "frame_loop.h"

namespace apriltrack::app {
namespace {

/// Recordings made one after the other by one camera may have clocks that start anew. A later one is moved
/// behind the earlier one, so that no two moments are taken for one; recordings of different cameras keep
/// their common clock.
class Clock {
 public:
  void place(const std::string& camera, std::vector<FrameDetections>& frames) {
    const std::size_t take = takes_[camera]++;
    if (shifts_ns_.size() <= take) shifts_ns_.push_back(shift_behind_previous(frames));
    for (FrameDetections& frame : frames) {
      frame.timestamp.ns += shifts_ns_[take];
      last_ns_ = std::max(last_ns_, frame.timestamp.ns);
    }
  }

 private:
  std::int64_t shift_behind_previous(const std::vector<FrameDetections>& frames) const {
    constexpr std::int64_t kGap_ns = 1'000'000'000;
    if (shifts_ns_.empty() || frames.empty() || frames.front().timestamp.ns > last_ns_) return 0;
    return last_ns_ + kGap_ns - frames.front().timestamp.ns;
  }

  std::map<std::string, std::size_t> takes_;  ///< Recordings so far, by camera.
  std::vector<std::int64_t> shifts_ns_;       ///< Of the first, second, ... recording of every camera.
  std::int64_t last_ns_ = 0;
};

void append(std::vector<FrameDetections> frames, std::vector<FrameDetections>& all) {
  all.insert(all.end(), std::make_move_iterator(frames.begin()), std::make_move_iterator(frames.end()));
}

std::set<std::string> camera_names(const std::vector<FrameDetections>& frames) {
  std::set<std::string> names;
  for (const FrameDetections& frame : frames) names.insert(frame.camera);
  return names;
}

}  // namespace

std::vector<Recording> parse_recordings(const std::vector<std::string>& inputs, const CameraRig& rig,
                                        const std::string& camera_name) {
  std::vector<Recording> recordings;
  for (const std::string& input : inputs) {
    const std::size_t equals = input.find('=');
    const bool is_named = equals != std::string::npos &&
                          input.substr(0, equals).find('/') == std::string::npos &&
                          !std::filesystem::exists(input);
    if (is_named && !camera_name.empty())
      throw invalid_input(
          "--camera-name",
          fmt::format("is '{}', but the input {} names its camera: leave one out", camera_name, input));
    if (is_named) {
      recordings.push_back({rig.find(input.substr(0, equals)).name, input.substr(equals + 1)});
    } else {
      recordings.push_back(
          {camera_name.empty() ? rig.cameras.front().name : rig.find(camera_name).name, input});
    }
  }
  return recordings;
}

Sightings detect_in(const std::vector<Recording>& recordings, const CameraRig& rig,
                    const DetectorOptions& detector, const SourceOptions& source_options, int num_threads,
                    const Console& console) {
  Sightings all;
  Clock clock;
  for (const Recording& recording : recordings) {
    const Camera& camera = rig.find(recording.camera);
    FrameLoopOptions options{detector, &camera, num_threads, "detect " + recording.input};
    options.detector.response = camera.response;
    const std::unique_ptr<FrameSource> source = open_source(recording.input, source_options);
    std::vector<FrameDetections> frames;
    const FrameCounts counts = detect_frames(*source, options, console, [&](DetectedFrame frame) {
      if (frame.source.is_readable())
        frames.push_back({frame.source.timestamp, camera.name, std::move(frame.detections)});
    });
    clock.place(recording.camera, frames);
    append(std::move(frames), all.frames);
    all.counts.readable += counts.readable;
    all.counts.unreadable += counts.unreadable;
    all.counts.is_interrupted = counts.is_interrupted;
    if (counts.is_interrupted) break;
  }
  return all;
}

Sightings read_sightings(const std::vector<std::string>& paths, const CameraRig& rig,
                         const std::string& camera_name) {
  Sightings all;
  Clock clock;
  for (const std::string& path : paths) {
    std::vector<FrameDetections> frames = read_detections_csv(path);
    const std::set<std::string> names = camera_names(frames);
    if (rig.cameras.size() == 1 && names.size() == 1) {
      for (FrameDetections& frame : frames) frame.camera = rig.cameras.front().name;
    }
    for (const std::string& name : camera_names(frames)) {
      if (!camera_name.empty() && name != camera_name) continue;
      rig.find(name);
      std::vector<FrameDetections> own;
      std::copy_if(frames.begin(), frames.end(), std::back_inserter(own),
                   [&](const FrameDetections& frame) { return frame.camera == name; });
      clock.place(name, own);
      append(std::move(own), all.frames);
    }
  }
  all.counts.readable = all.frames.size();
  if (!camera_name.empty() && all.frames.empty()) {
    rig.find(camera_name);
    throw no_result("calibrate", fmt::format("the detection files have no rows of camera {}", camera_name));
  }
  return all;
}

}  // namespace apriltrack::app
