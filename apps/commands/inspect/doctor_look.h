#pragma once

#include <string>
#include <vector>

#include "apriltrack/inspect/inspect_recording.h"
#include "cli/console.h"
#include "files/frame_options.h"

namespace apriltrack::app {

struct LookOptions {
  std::string camera;  ///< File; empty: a sequence folder's own, where there is one.
  std::string camera_name;
  FrameOptions frames;
  InspectionOptions inspection;  ///< Without progress and should_stop.
};

/// Inspects every INPUT (inspect_recording()), of a bag with several cameras each of them, and joins what was
/// seen. Ctrl-C ends it, with the facts until then. Throws as inspect_recording, join_recordings and
/// read_cameras do.
InspectionFacts look_at(const std::vector<std::string>& inputs, const LookOptions& options,
                        const Console& console);

}  // namespace apriltrack::app
