#pragma once

#include <exception>

#include "apriltrack/base/parallel.h"
#include "apriltrack/base/should_stop.h"

namespace apriltrack {

/// Leaves work that is no longer wanted. Not an Error: whoever tries another way after a failure must let it
/// pass.
class Stopped : public std::exception {
 public:
  const char* what() const noexcept override { return "stopped before its end"; }
};

/// `parallel` that asks before each of its bodies, and throws Stopped.
ParallelFor stoppable(ParallelFor parallel, ShouldStop should_stop);

}  // namespace apriltrack
