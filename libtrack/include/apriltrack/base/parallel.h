#pragma once

#include <cstddef>
#include <functional>

namespace apriltrack {

/// Runs body(0) ... body(count - 1), in any order and perhaps side by side; returns when all are done.
///
/// A value handed to whoever has independent work, so that threads are an argument and never a global.
/// The first exception thrown by a body is rethrown to the caller after all running bodies have ended.
using ParallelFor = std::function<void(std::size_t count, const std::function<void(std::size_t)>& body)>;

/// num_threads: 1 = serial, in order; 0 = as many as the machine has cores.
ParallelFor parallel_for(int num_threads);

}  // namespace apriltrack
