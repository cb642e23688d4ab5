#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "apriltrack/eval/evaluate_frame_log.h"
#include "apriltrack/eval/evaluate_trajectory.h"

namespace apriltrack::app {

/// The figures of an evaluation, for machines and for people; lengths in mm, angles in degrees.
nlohmann::json to_json(const TrajectoryEvaluation& evaluation);
void add_log(nlohmann::json& out, const FrameLogEvaluation& log);
std::string to_text(const TrajectoryEvaluation& evaluation);
std::string to_text(const FrameLogEvaluation& log);

}  // namespace apriltrack::app
