#pragma once

#include <functional>

namespace apriltrack {

/// Whether work is no longer wanted; once true, it stays so. Asked often, by each of the threads at work.
/// Empty: never.
using ShouldStop = std::function<bool()>;

/// Asks `should_stop`; false where it is empty.
inline bool asks_to_stop(const ShouldStop& should_stop) {
  return should_stop && should_stop();
}

}  // namespace apriltrack
