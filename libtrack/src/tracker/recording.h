#pragma once

#include <cstdint>
#include <optional>

#include "apriltrack/base/timestamp.h"
#include "apriltrack/photometric/photometric_world.h"
#include "apriltrack/tracker/blur_tracker.h"
#include "blur_judge.h"
#include "frame_exposures.h"
#include "motion_memory.h"
#include "pose_report.h"
#include "tag_consensus.h"
#include "tag_reader.h"
#include "tag_search.h"
#include "turn_watch.h"

namespace apriltrack {

/// All that is known of one recording, frame after frame: the next one begins with another of these, so that
/// nothing of the last is left. options, world, reader: must outlive it. map: the world's.
struct Recording {
  Recording(const BlurTrackerOptions& options, const TagMap& map, PhotometricWorld& world, TagReader& reader)
      : motion(options.motion_noise, options.max_prediction_s),
        exposures(options.motion_noise, options.default_exposure_s),
        search(reader, world),
        consensus(map, world, options),
        report(world) {
    if (options.mode == TrackMode::kEgo && options.is_scene_at_rest) turns.emplace(world.model);
  }

  std::optional<Timestamp> last_time;
  std::uint64_t num_frames = 0;
  MotionMemory motion;
  std::optional<TurnWatch> turns;  ///< Where the scene tells them.
  FrameExposures exposures;
  TagSearch search;
  BlurJudge judge;
  TagConsensus consensus;
  PoseReport report;
};

}  // namespace apriltrack
