#include "apriltrack/base/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "apriltrack/base/check.h"

namespace apriltrack {
namespace {

/// Work handed out index by index; remembers the first exception and stops handing out after it.
class SharedLoop {
 public:
  SharedLoop(std::size_t count, const std::function<void(std::size_t)>& body) : count_(count), body_(body) {}

  void run() {
    for (std::size_t i = next_++; i < count_ && !failed_; i = next_++) {
      try {
        body_(i);
      } catch (...) {  // carried over to the calling thread, which rethrows it
        const std::lock_guard lock(mutex_);
        if (!failed_.exchange(true)) error_ = std::current_exception();
      }
    }
  }

  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  const std::size_t count_;
  const std::function<void(std::size_t)>& body_;
  std::atomic<std::size_t> next_ = 0;
  std::atomic<bool> failed_ = false;
  std::mutex mutex_;
  std::exception_ptr error_;
};

void run_on_threads(std::size_t num_threads, std::size_t count,
                    const std::function<void(std::size_t)>& body) {
  SharedLoop loop(count, body);
  {
    std::vector<std::jthread> helpers;
    for (std::size_t i = 1; i < std::min(num_threads, count); ++i)
      helpers.emplace_back([&loop] { loop.run(); });
    loop.run();
  }
  loop.rethrow();
}

}  // namespace

ParallelFor parallel_for(int num_threads) {
  APRILTRACK_CHECK(num_threads >= 0, "num_threads must be 0 (all cores) or more");
  const std::size_t threads = num_threads > 0 ? static_cast<std::size_t>(num_threads)
                                              : std::max<std::size_t>(1, std::thread::hardware_concurrency());
  return [threads](std::size_t count, const std::function<void(std::size_t)>& body) {
    if (threads == 1) {
      for (std::size_t i = 0; i < count; ++i) body(i);
    } else {
      run_on_threads(threads, count, body);
    }
  };
}

}  // namespace apriltrack
