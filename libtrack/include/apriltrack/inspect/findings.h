#pragma once

#include <span>
#include <string>
#include <vector>

#include "apriltrack/inspect/finding.h"
#include "apriltrack/inspect/recording_facts.h"

namespace apriltrack {

/// All findings: what stops a calibration first, then warnings, then notes. If there are several recordings,
/// a text begins with the one that it is about.
std::vector<RecordingFinding> inspection_findings(const InspectionFacts& facts);

enum class CalibrationReadiness { kReady, kReadyWithWarnings, kNotReady };

/// Whether the recordings can be calibrated.
struct CalibrationVerdict {
  CalibrationReadiness readiness = CalibrationReadiness::kReady;
  std::string text;  ///< One line, for people.
};
/// findings: of inspection_findings(). has_tags: whether any tag of the families asked for was seen.
CalibrationVerdict verdict_of(std::span<const RecordingFinding> findings, bool has_tags);

}  // namespace apriltrack
