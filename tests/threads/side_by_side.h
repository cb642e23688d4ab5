#pragma once

#include <cstddef>
#include <latch>
#include <thread>
#include <vector>

namespace apriltrack::test {

/// work(0) ... work(count - 1), each on a thread of its own; none begins before all threads are there.
template <class Work>
auto side_by_side(std::size_t count, const Work& work) {
  std::vector<decltype(work(std::size_t{}))> results(count);
  std::latch all_here(static_cast<std::ptrdiff_t>(count));
  std::vector<std::jthread> threads;
  for (std::size_t i = 0; i < count; ++i) {
    threads.emplace_back([&, i] {
      all_here.arrive_and_wait();
      results[i] = work(i);
    });
  }
  threads.clear();  // joins
  return results;
}

/// The same on the calling thread, one after the other.
template <class Work>
auto one_by_one(std::size_t count, const Work& work) {
  std::vector<decltype(work(std::size_t{}))> results(count);
  for (std::size_t i = 0; i < count; ++i) results[i] = work(i);
  return results;
}

}  // namespace apriltrack::test
