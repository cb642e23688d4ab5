#include "doctor_look.h"

#include <optional>
#include <utility>

#include "apriltrack/camera/auto_response.h"
#include "apriltrack/source/bag_input.h"
#include "files/inputs.h"
#include "files/recordings.h"
#include "files/topics.h"

namespace apriltrack::app {
namespace {

/// The camera that films an INPUT; only its name where no file tells more.
void find_camera(const Recording& named, const LookOptions& options, const Console& console,
                 InspectedInput& inspected) {
  inspected.camera_name = named.is_named ? named.camera : options.camera_name;
  const auto source = camera_source(options.camera, named.input, inspected.camera_name);
  if (source && is_bag_input(source->path.string())) {
    inspected.camera = bag_camera(named.input, named.topic, console.log());
    if (inspected.camera && !inspected.camera_name.empty()) inspected.camera->name = inspected.camera_name;
  } else if (source) {
    inspected.camera = read_camera(*source, inspected.camera_name, console);
  }
  if (inspected.camera) inspected.camera_name = inspected.camera->name;
  if (inspected.camera_name.empty()) inspected.camera_name = "cam0";
}

InspectedInput inspected_input(const Recording& named, const LookOptions& options, const Console& console) {
  InspectedInput inspected{.name = named.name(), .input = named.input};
  find_camera(named, options, console, inspected);
  inspected.source = options.frames.source;
  inspected.source.log = console.log();
  inspected.source.camera_name = named.is_named ? named.camera : options.camera_name;
  inspected.source.topic = named.topic;
  if (inspected.camera) set_shutter(inspected.source, *inspected.camera);
  return inspected;
}

/// Each INPUT, and of a bag with several cameras each of them.
std::vector<Recording> recordings_of(const std::vector<std::string>& inputs, const LookOptions& options,
                                     const Console& console) {
  std::optional<CameraRig> rig;
  if (!options.camera.empty()) rig = read_cameras_to_estimate(options.camera).rig;
  std::vector<Recording> recordings;
  for (const std::string& input : inputs) {
    Recording recording = split_input(input);
    if (!recording.is_named && !options.camera_name.empty()) recording = {options.camera_name, input, true};
    if (recording.camera.empty() && rig) recording.camera = rig->cameras.front().name;
    recordings.push_back(std::move(recording));
  }
  return with_topics(std::move(recordings), options.frames.topics, rig ? &*rig : nullptr, options.camera,
                     console);
}

}  // namespace

InspectionFacts look_at(const std::vector<std::string>& inputs, const LookOptions& options,
                        const Console& console) {
  InspectionOptions inspection = options.inspection;
  inspection.progress = progress_on(console);
  inspection.should_stop = is_interrupted;
  std::vector<RecordingFacts> recordings;
  for (const Recording& recording : recordings_of(inputs, options, console)) {
    recordings.push_back(inspect_recording(inspected_input(recording, options, console), inspection));
    if (!recordings.back().is_interrupted) continue;
    console.warning(kInterrupted);
    break;
  }
  return join_recordings(inspection.detector.families, std::move(recordings));
}

}  // namespace apriltrack::app
