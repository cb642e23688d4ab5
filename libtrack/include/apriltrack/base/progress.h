#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>

namespace apriltrack {

/// Called after each step of some work.
using ProgressStep = std::function<void()>;

/// Called when some work begins: what is done, and its number of steps, nullopt where it is not known. The
/// work has ended when the ProgressStep that it returns is destroyed. Empty: nobody asks.
using ProgressSink = std::function<ProgressStep(const std::string& task, std::optional<std::size_t> steps)>;

/// `progress`, or steps that do nothing where it is empty.
inline ProgressStep begin_progress(const ProgressSink& progress, const std::string& task,
                                   std::optional<std::size_t> steps) {
  return progress ? progress(task, steps) : ProgressStep([] {});
}

}  // namespace apriltrack
