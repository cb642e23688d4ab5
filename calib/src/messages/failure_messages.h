#pragma once

#include <string>

#include "apriltrack/base/error.h"
#include "observations/observations.h"

namespace apriltrack {

/// Why no map came, with the faults that were found before. error: HeldTagAtFault, NothingLeft, or any other,
/// whose cause it is.
std::string cause_of(const Observations& observations, const Error& error);

}  // namespace apriltrack
