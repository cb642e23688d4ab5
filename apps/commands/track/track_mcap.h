#pragma once

#include <filesystem>
#include <memory>
#include <span>

#include "apriltrack/camera/camera.h"
#include "apriltrack/io/staged_files.h"
#include "apriltrack/source/frame_source.h"
#include "apriltrack/tags/tag_map.h"
#include "apriltrack/tracker/track_result.h"
#include "tag_sights.h"

namespace apriltrack::app {

/// A run as an MCAP file that Foxglove shows as it is (docs/file_formats.md lists the topics), written as
/// frames are done.
class TrackMcap {
 public:
  struct Options {
    TrackMode mode = TrackMode::kEgo;
    bool with_images = false;
  };

  /// files: must outlive it. Throws Error(kIo).
  TrackMcap(StagedFiles& files, const std::filesystem::path& path, const Camera& camera, const TagMap& map,
            const Options& options);
  ~TrackMcap();

  /// image: nullptr where corners alone were tracked. Throws Error(kIo), Error(kInvalidInput) for times that
  /// the format does not have.
  void add(const TrackResult& result, std::span<const TagSight> sights, const SourceFrame* image);
  void add_unreadable(const SourceFrame& frame);
  /// Completes the file.
  void close();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace apriltrack::app
