#include "model/solve_context.h"

#include "apriltrack/calib/stop.h"

namespace apriltrack {

ParallelFor on_one_thread(const PartTask& task) {
  return stoppable(parallel_for(1), task.options.should_stop);
}

}  // namespace apriltrack
