#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apriltrack/calib/assess_map.h"
#include "apriltrack/calib/refine_map.h"

namespace apriltrack::app {

/// What is said of a calibration beside the map itself: on the terminal, for machines, and on the page.
struct CalibrationFindings {
  MapAssessment of_map;
  std::vector<MapAssessment> of_other_parts;
  std::vector<JoinAdvice> joining;
  const JointCovariance* joint =
      nullptr;  ///< Of the map as written: by pictures where it was refined by them.
};

/// A list of their names.
nlohmann::json told_keys(const std::vector<TagKey>& keys);

/// An edge offset is the detector's; all else is the camera's.
bool is_lens_refined(const CalibrationResult& result);

/// refinement: none where it was not asked for. Refers to both.
CalibrationFindings find(const CalibrationResult& result, const std::optional<RefinementResult>& refinement,
                         const std::vector<FrameDetections>& frames);

/// Adds weak_directions, hanging, advice, joining and cross_validation.
void tell_machines(const CalibrationFindings& findings, const CalibrationResult& result,
                   nlohmann::json& summary);
/// A few lines, each with a line break before it; empty where all is well.
std::string tell_people(const CalibrationFindings& findings, const CalibrationResult& result);

}  // namespace apriltrack::app
