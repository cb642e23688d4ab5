#pragma once

#include <filesystem>
#include <string>

#include "apriltrack/camera/camera.h"
#include "apriltrack/tags/tag_map.h"
#include "camera_response.h"
#include "track_options.h"
#include "track_record.h"

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

/// The page of `track --report`, one file that needs no network: how far the run can be trusted, where not,
/// and why. Its pictures keep their size however long the recording is. Also of a run without a pose.
/// Throws Error(kIo).
void write_track_report(const std::filesystem::path& path, const TrackRun& run);

}  // namespace apriltrack::app
