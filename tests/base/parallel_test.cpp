#include "apriltrack/base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <numeric>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include "apriltrack/base/check.h"

namespace apriltrack {
namespace {

class ForAnyNumberOfThreads : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(ParallelFor, ForAnyNumberOfThreads, testing::Values(0, 1, 2, 5, 16));

TEST_P(ForAnyNumberOfThreads, RunsEveryIndexOnce) {
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{3}, std::size_t{1000}}) {
    std::vector<std::atomic<int>> runs(count);
    parallel_for(GetParam())(count, [&](std::size_t i) { ++runs[i]; });
    for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(runs[i], 1) << i;
  }
}

TEST_P(ForAnyNumberOfThreads, ReturnsOnlyWhenAllIsDone) {
  std::vector<int> squares(200);  // plain ints: a body that still ran afterwards would be a data race
  parallel_for(GetParam())(squares.size(), [&](std::size_t i) { squares[i] = static_cast<int>(i * i); });
  EXPECT_EQ(std::accumulate(squares.begin(), squares.end(), 0), 199 * 200 * 399 / 6);
}

TEST_P(ForAnyNumberOfThreads, HandsTheExceptionToTheCaller) {
  std::atomic<int> num_running = 0;
  try {
    parallel_for(GetParam())(100, [&](std::size_t i) {
      ++num_running;
      if (i == 40) {
        --num_running;
        throw std::runtime_error("index 40");
      }
      --num_running;
    });
    FAIL() << "the exception was swallowed";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "index 40");
  }
  EXPECT_EQ(num_running, 0) << "every running body has ended";
}

TEST_P(ForAnyNumberOfThreads, CanBeUsedAgainAfterAnException) {
  const ParallelFor run = parallel_for(GetParam());
  EXPECT_THROW(run(10, [](std::size_t) { throw std::logic_error("all fail"); }), std::logic_error);
  std::atomic<int> count = 0;
  run(10, [&](std::size_t) { ++count; });
  EXPECT_EQ(count, 10);
}

TEST_P(ForAnyNumberOfThreads, CanBeNested) {
  std::atomic<int> count = 0;
  const ParallelFor run = parallel_for(GetParam());
  run(4, [&](std::size_t) { run(4, [&](std::size_t) { ++count; }); });
  EXPECT_EQ(count, 16);
}

TEST(ParallelFor, OneThreadRunsInOrderOnTheCaller) {
  std::vector<std::size_t> order;
  std::set<std::thread::id> threads;
  parallel_for(1)(50, [&](std::size_t i) {
    order.push_back(i);
    threads.insert(std::this_thread::get_id());
  });
  std::vector<std::size_t> expected(50);
  std::iota(expected.begin(), expected.end(), std::size_t{0});
  EXPECT_EQ(order, expected);
  EXPECT_EQ(threads, std::set{std::this_thread::get_id()});
}

TEST(ParallelFor, SeveralThreadsReallyRunSideBySide) {
  // Each of three bodies waits until all three have begun: on fewer threads this would never end.
  std::mutex mutex;
  std::condition_variable all_here;
  int num_here = 0;
  parallel_for(3)(3, [&](std::size_t) {
    std::unique_lock lock(mutex);
    if (++num_here == 3) all_here.notify_all();
    all_here.wait(lock, [&] { return num_here == 3; });
  });
  EXPECT_EQ(num_here, 3);
}

TEST(ParallelFor, RefusesANegativeNumberOfThreads) {
  EXPECT_THROW(parallel_for(-1), MisuseError);
}

}  // namespace
}  // namespace apriltrack
