#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "apriltrack/camera/camera.h"
#include "apriltrack/eval/evaluate_frame_log.h"
#include "apriltrack/eval/evaluate_trajectory.h"
#include "apriltrack/tags/tag_map.h"
#include "track_options.h"
#include "track_record.h"

namespace apriltrack::app {

/// A run against the truth that its recording brings, as `evaluate --truth INPUT` scores it: with the
/// recording's own camera and map where it has them, and not aligned. Of an interrupted run the frames that
/// it came to: none is lost that was never tried.
struct TruthScore {
  TrajectoryEvaluation evaluation;
  FrameLogEvaluation log;
  /// True frames after the last one that was tried, which are not scored.
  std::size_t untried = 0;
  bool is_map_the_recordings = true;  ///< Otherwise the frames of the two maps may differ.
  Trajectory truth;                   ///< The true poses that are scored.
};

/// nullopt where INPUT is no folder with a truth.tum, or the run has no pose. Throws Error where the two
/// cannot be compared.
std::optional<TruthScore> score_against_truth(const TrackArguments& arguments, const Camera& camera,
                                              const TagMap& map, const TrackRecord& record,
                                              bool was_interrupted);

}  // namespace apriltrack::app
