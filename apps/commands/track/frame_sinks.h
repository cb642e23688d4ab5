#pragma once

#include <optional>
#include <span>
#include <string>

#include "apriltrack/camera/camera.h"
#include "apriltrack/io/staged_files.h"
#include "apriltrack/source/frame_source.h"
#include "apriltrack/tags/tag_map.h"
#include "apriltrack/tracker/track_result.h"
#include "pose_stream.h"
#include "tag_sights.h"
#include "tags_csv.h"
#include "track_mcap.h"
#include "track_options.h"
#include "track_video.h"

namespace apriltrack::app {

/// What `track` writes frame by frame while it runs: --video, --tags-csv, --output as MCAP or to stdout.
class FrameSinks {
 public:
  /// Throws Error(kIo) where one cannot be begun.
  FrameSinks(const TrackArguments& arguments, const Camera& camera, const TagMap& map);

  /// image: nullptr where corners alone are tracked.
  void add(const TrackResult& result, std::span<const TagSight> sights, const SourceFrame* image);
  void add_unreadable(const SourceFrame& frame);

  /// Completes what was written. The video goes among `files`; commit() puts the rest in place.
  void close(StagedFiles& files);
  void commit();

 private:
  StagedFiles files_;
  std::optional<TrackVideo> video_;
  std::optional<TagsCsv> tags_csv_;
  std::optional<TrackMcap> mcap_;
  std::optional<PoseStream> poses_;
};

}  // namespace apriltrack::app
