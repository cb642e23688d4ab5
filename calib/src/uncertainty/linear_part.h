#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "apriltrack/calib/calibration_options.h"
#include "model/map_state.h"
#include "model/solve_context.h"
#include "uncertainty/error_scale.h"
#include "uncertainty/pose_information.h"

namespace apriltrack {

/// A part linearised at one state of its map, each tag and frame but the held tag free.
struct LinearPart {
  Part part;
  std::vector<LinearView> views;  ///< Those of the part.
  /// None where the views leave a pose undetermined, or a view cannot be predicted. Refers to `views`.
  std::optional<PoseInformation> poses;
  ErrorScale scale;

  LinearPart(const Observations& observations, const CalibrationOptions& options, const MapState& state,
             Part part_of_map, int held_tag);
  LinearPart(const PartTask& task, const MapState& state, Part part_of_map, int held_tag)
      : LinearPart(task.observations, task.options, state, std::move(part_of_map), held_tag) {}
  LinearPart(const LinearPart&) = delete;
  LinearPart& operator=(const LinearPart&) = delete;
};

/// Of the errors that tags keep, in units of the corners' noise.
double expected_bias_variance(const CalibrationOptions& options);

}  // namespace apriltrack
