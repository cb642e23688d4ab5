#pragma once

#include <optional>
#include <vector>

#include "apriltrack/report/scene_view.h"
#include "commands/track/track_truth.h"
#include "pages/map_drawings.h"
#include "track_run.h"

namespace apriltrack::app {

/// How a tag of the map fared in the whole run.
enum class TagFate {
  kSeen,
  kSuspect,    ///< In some frame it was not where the map has it.
  kNeverSeen,  ///< Poses put it into the image, and it was not there.
  kNeverInView,
};
TagFate fate_of(const TrackRecord& record, const TagKey& tag);

/// The recording's true poses where they are in the frame of the run's map; none otherwise.
Trajectory truth_to_draw(const std::optional<TruthScore>& score);

/// The path with the map's tags, from above and from two sides; with a body's tags at its first pose, in the
/// camera's frame. Requires a pose.
std::vector<MapDrawing> draw_path(const TrackRun& run, const Trajectory& truth);

/// The run in space: the camera moves in the map, or the body before the camera. Requires a pose.
SceneView scene_of_track(const TrackRun& run, const Trajectory& truth);
std::string caption_of_track_scene(const TrackRun& run);

}  // namespace apriltrack::app
