#include "apriltrack/detect/batch_detector.h"

#include <algorithm>
#include <chrono>
#include <thread>

namespace apriltrack {
namespace {

int resolved_threads(int num_threads) {
  if (num_threads > 0) return num_threads;
  constexpr int kMaxDefaultThreads = 8;  // every detector holds decoding tables of 38 MB (tag36h11)
  return std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, kMaxDefaultThreads);
}

BatchDetector::Found find_timed(Detector& detector, const GrayView& image) {
  const auto start = std::chrono::steady_clock::now();
  BatchDetector::Found found{detector.find(image)};
  found.latency_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return found;
}

}  // namespace

BatchDetector::BatchDetector(const DetectorOptions& options, int num_threads)
    : parallel_for_(parallel_for(resolved_threads(num_threads))) {
  for (int i = 0; i < resolved_threads(num_threads); ++i) detectors_.emplace_back(options);
}

std::vector<BatchDetector::Found> BatchDetector::find(std::span<const GrayView> images) {
  std::vector<Found> found(images.size());
  parallel_for_(detectors_.size(), [&](std::size_t thread) {
    for (std::size_t i = thread; i < images.size(); i += detectors_.size())
      if (!images[i].is_empty()) found[i] = find_timed(detectors_[thread], images[i]);
  });
  return found;
}

}  // namespace apriltrack
