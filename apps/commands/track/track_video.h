#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apriltrack/camera/camera.h"
#include "apriltrack/report/overlay_video.h"
#include "apriltrack/source/frame_source.h"
#include "apriltrack/tags/tag_map.h"
#include "apriltrack/tracker/track_result.h"

namespace apriltrack {
class StagedFiles;
}

namespace apriltrack::app {

/// The recording again, every mapped tag outlined where the pose puts it, in the colour of the status
/// (`track --video`).
class TrackVideo {
 public:
  /// The file is made with the second frame, when the rate is known.
  TrackVideo(std::filesystem::path path, const Camera& camera, const TagMap& map, TrackMode mode);

  void add(const SourceFrame& frame, const TrackResult& result);
  /// A frame that could not be decoded shows the picture before it; one that has none before it is left out.
  void add_unreadable(Timestamp timestamp);
  /// Completes the file and puts it among `files`; without it none is left.
  void close(StagedFiles& files);

 private:
  struct Shown {
    Timestamp timestamp;
    GrayImage image;
    std::vector<ColouredOutline> outlines;
    std::string caption;
    Colour colour;
  };
  std::vector<ColouredOutline> outlines(const TrackResult& result) const;
  void show(Shown shown);
  void write(const Shown& shown);

  const std::filesystem::path path_;
  const Camera camera_;
  const TagMap map_;
  const TrackMode mode_;
  std::optional<OverlayVideo> video_;
  std::optional<Timestamp> start_;
  std::optional<Shown> last_;
};

}  // namespace apriltrack::app
