#pragma once

#include <string>
#include <vector>

#include "apriltrack/base/parallel.h"
#include "initialise/part_adjustment.h"
#include "solve/camera_parameters.h"

namespace apriltrack {

/// How far frames that a map was not made from disagree with it, in standard deviations (root mean square):
/// with the cameras as they are, and with a map and cameras refined from the same frames.
struct CameraTrial {
  bool is_passed = false;  ///< They agree better, by more than chance, and by the share that was asked for.
  std::string reason;      ///< Why not.
  double held_out_before = 0.0, held_out_after = 0.0;
};

/// least_gain: a share. refined: `solved` by the cameras that all frames together give, near which those are
/// that most of them do.
CameraTrial try_cameras(const PartTask& task, const CameraParameters& parameters, double least_gain,
                        const AdjustedPart& solved, const MapState& refined, const ParallelFor& parallel);

}  // namespace apriltrack
