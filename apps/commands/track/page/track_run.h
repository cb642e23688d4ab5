#pragma once

#include <string>

#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/response_finding.h"
#include "apriltrack/tags/tag_map.h"
#include "commands/track/track_options.h"
#include "commands/track/track_record.h"

namespace apriltrack::app {

/// What a run was made from, and what came of it.
struct TrackRun {
  std::string command_line;
  const TrackArguments& arguments;
  std::string camera_file, map_file;
  const Camera& camera;
  const TagMap& map;
  const TrackRecord& record;
  const ResponseFinding& response;
  bool was_interrupted = false;
};

}  // namespace apriltrack::app
