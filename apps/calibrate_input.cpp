#include "calibrate_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <filesystem>
#include <map>
#include <set>
#include <thread>

#include "apriltrack/base/error.h"
#include "apriltrack/base/parallel.h"
#include "apriltrack/detect/detections_csv.h"

namespace apriltrack::app {
namespace {

constexpr std::size_t kFramesPerThread = 4;  // evens out slow frames

int resolved_threads(int num_threads) {
  if (num_threads > 0) return num_threads;
  constexpr int kMaxDefaultThreads = 8;  // every detector holds decoding tables of 38 MB (tag36h11)
  return std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, kMaxDefaultThreads);
}

/// One recording's frames through as many detectors as there are threads.
class RecordingDetector {
 public:
  RecordingDetector(const Camera& camera, DetectorOptions options, int num_threads)
      : camera_(camera), parallel_for_(parallel_for(num_threads)) {
    options.response = camera.response;
    for (int i = 0; i < num_threads; ++i) detectors_.emplace_back(options);
  }

  void run(FrameSource& source, const Console& console, Sightings& sightings) {
    Progress progress(console, "detect " + source.name(), source.num_frames());
    while (true) {
      sightings.is_interrupted = is_interrupted();
      if (sightings.is_interrupted) return;
      const std::vector<SourceFrame> batch = read(source);
      if (batch.empty()) return;
      detect(batch, console, sightings);
      progress.advance(batch.size());
    }
  }

 private:
  std::vector<SourceFrame> read(FrameSource& source) const {
    std::vector<SourceFrame> batch;
    while (batch.size() < kFramesPerThread * detectors_.size()) {
      std::optional<SourceFrame> frame = source.next();
      if (!frame) break;
      if (frame->is_readable())
        check_resolution(camera_, frame->pixels.width(), frame->pixels.height(), frame->name);
      batch.push_back(std::move(*frame));
    }
    return batch;
  }

  void detect(const std::vector<SourceFrame>& batch, const Console& console, Sightings& sightings) {
    std::vector<std::vector<Detection>> found(batch.size());
    parallel_for_(detectors_.size(), [&](std::size_t thread) {
      for (std::size_t i = thread; i < batch.size(); i += detectors_.size()) {
        if (batch[i].is_readable()) found[i] = detectors_[thread].detect(batch[i].pixels.view());
      }
    });
    for (std::size_t i = 0; i < batch.size(); ++i) {
      if (!batch[i].is_readable()) {
        if (sightings.frames_unreadable++ == 0)
          console.warning(fmt::format("{} cannot be read: {}", batch[i].name, batch[i].error));
        continue;
      }
      ++sightings.frames_read;
      sightings.frames.push_back({batch[i].timestamp, camera_.name, std::move(found[i])});
    }
  }

  const Camera& camera_;
  ParallelFor parallel_for_;
  std::deque<Detector> detectors_;
};

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
                    const DetectorOptions& options, const SourceOptions& source_options, int num_threads,
                    const Console& console) {
  Sightings all;
  Clock clock;
  for (const Recording& recording : recordings) {
    const std::unique_ptr<FrameSource> source = open_source(recording.input, source_options);
    RecordingDetector detector(rig.find(recording.camera), options, resolved_threads(num_threads));
    Sightings sightings;
    detector.run(*source, console, sightings);
    if (sightings.frames_read == 0 && !sightings.is_interrupted)
      throw io_error(recording.input,
                     sightings.frames_unreadable > 0
                         ? fmt::format("none of its {} frames can be read", sightings.frames_unreadable)
                         : "has no frames");
    clock.place(recording.camera, sightings.frames);
    append(std::move(sightings.frames), all.frames);
    all.frames_read += sightings.frames_read;
    all.frames_unreadable += sightings.frames_unreadable;
    all.is_interrupted = sightings.is_interrupted;
    if (all.is_interrupted) break;
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
  all.frames_read = all.frames.size();
  if (!camera_name.empty() && all.frames.empty()) {
    rig.find(camera_name);
    throw no_result("calibrate", fmt::format("the detection files have no rows of camera {}", camera_name));
  }
  return all;
}

}  // namespace apriltrack::app
