#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apriltrack/base/progress.h"
#include "apriltrack/base/should_stop.h"
#include "apriltrack/detect/detector.h"
#include "apriltrack/inspect/recording_facts.h"
#include "apriltrack/source/frame_source.h"

namespace apriltrack {

/// A recording to be inspected, and the camera that filmed it.
struct InspectedInput {
  std::string name;   ///< What messages call it.
  std::string input;  ///< As for open_source().
  /// As for open_source(). Images whose names are no times are taken at 1 Hz if rate_hz is not given. log
  /// hears of frames that are unreadable, or copies, too.
  SourceOptions source = {};
  std::string camera_name = "cam0";             ///< What findings call the camera.
  std::optional<Camera> camera = std::nullopt;  ///< nullopt: nothing is known of it.
};

struct InspectionOptions {
  DetectorOptions detector = {};  ///< response and camera_model are those of each recording's camera.
  int num_threads = 0;            ///< 0: as many as there are cores, 8 at most; changes no result.
  bool tries_other_families = true;
  ProgressSink progress = {};
  ShouldStop should_stop = {};
};

/// Reads every frame of a recording, finds the tags of the families asked for and measures their blur. Looks
/// for all other families in small copies of a few frames, and, if hardly a tag is read, for tags in the
/// mirror image and the negative of up to 4. should_stop ends it early, with the facts until then.
/// Throws as open_source() and detect_frames() do.
RecordingFacts inspect_recording(const InspectedInput& recording, const InspectionOptions& options);

/// Joins the facts of recordings: which tags are seen together from which viewpoints. Frames of several
/// cameras belong together if their times are equal. families: those that were asked for. Throws as
/// SessionClocks::align() does.
InspectionFacts join_recordings(std::vector<std::string> families, std::vector<RecordingFacts> recordings);

}  // namespace apriltrack
