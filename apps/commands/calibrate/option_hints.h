#pragma once

#include <string>

#include "apriltrack/base/error.h"
#include "apriltrack/calib/calibration_finding.h"

namespace apriltrack::app {

/// The finding's message, with the options of `calibrate` by which something can be done about it.
std::string message_with_options(const CalibrationFinding& finding);

/// An error of the library that names an option as the API does ("held_tag"), in the words of the command
/// line.
Error with_options(const Error& error);

}  // namespace apriltrack::app
