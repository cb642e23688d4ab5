#pragma once

#include <deque>
#include <span>
#include <vector>

#include "apriltrack/base/parallel.h"
#include "apriltrack/detect/detector.h"

namespace apriltrack {

/// Finds tags in several images side by side: each thread has a detector of its own, so that the number of
/// threads changes no result. One call at a time.
class BatchDetector {
 public:
  /// num_threads: 0 = one for each core, at most 8 (the decoding tables of a detector take up to 38 MB).
  /// Throws as Detector does.
  explicit BatchDetector(const DetectorOptions& options, int num_threads = 0);

  std::size_t num_threads() const { return detectors_.size(); }

  /// What was found in one image.
  struct Found {
    FoundTags tags;
    double latency_s = 0.0;  ///< Of this image's search, with other threads at work beside it.
  };
  /// One for each image, in their order; empty images have no tags. A multiple of num_threads() images at
  /// once keeps all threads busy.
  std::vector<Found> find(std::span<const GrayView> images);

 private:
  ParallelFor parallel_for_;
  std::deque<Detector> detectors_;
};

}  // namespace apriltrack
