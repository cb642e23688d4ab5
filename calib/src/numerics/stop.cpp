#include "apriltrack/calib/stop.h"

#include <cstddef>
#include <utility>

#include "apriltrack/base/parallel.h"

namespace apriltrack {

ParallelFor stoppable(ParallelFor parallel, ShouldStop should_stop) {
  if (!should_stop) return parallel;
  return [parallel = std::move(parallel), should_stop = std::move(should_stop)](
             std::size_t count, const std::function<void(std::size_t)>& body) {
    parallel(count, [&](std::size_t i) {
      if (should_stop()) throw Stopped();
      body(i);
    });
  };
}

}  // namespace apriltrack
