#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

#include "apriltrack/inspect/findings.h"

namespace apriltrack::app {

/// For people: each recording, the tags, notes and the verdict; warnings have been heard by then.
std::string told_facts(const InspectionFacts& facts, std::span<const RecordingFinding> findings,
                       const CalibrationVerdict& verdict);

/// For programs (docs/file_formats.md).
nlohmann::json json_of(const InspectionFacts& facts, std::span<const RecordingFinding> findings,
                       const CalibrationVerdict& verdict);

}  // namespace apriltrack::app
