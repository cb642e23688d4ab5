#include "frame_loop.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <thread>

#include "apriltrack/base/error.h"
#include "apriltrack/base/parallel.h"

namespace apriltrack::app {
namespace {

constexpr std::size_t kFramesPerThread = 4;  // evens out slow frames; a 2 MP frame takes 2 MB

int resolved_threads(int num_threads) {
  if (num_threads > 0) return num_threads;
  constexpr int kMaxDefaultThreads = 8;  // every detector holds decoding tables of 38 MB (tag36h11)
  return std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, kMaxDefaultThreads);
}

/// Holds every image against the camera's resolution.
class ResolutionCheck {
 public:
  explicit ResolutionCheck(const Camera* camera) : camera_(camera) {}

  void operator()(const SourceFrame& frame) {
    if (!camera_ || !frame.is_readable()) return;
    const int width = frame.pixels.width();
    const int height = frame.pixels.height();
    check_resolution(*camera_, width, height, frame.name);
    if (first_width_ == 0) {
      first_width_ = width;
      first_height_ = height;
    }
    if (width == first_width_ && height == first_height_) return;
    throw invalid_input(frame.name, fmt::format("is {} x {} pixels, but the first image is {} x {}: one "
                                                "calibration cannot hold for both",
                                                width, height, first_width_, first_height_));
  }

 private:
  const Camera* camera_;
  int first_width_ = 0;
  int first_height_ = 0;
};

class BatchDetector {
 public:
  explicit BatchDetector(const FrameLoopOptions& options)
      : check_resolution_(options.camera),
        parallel_for_(parallel_for(resolved_threads(options.num_threads))) {
    for (int i = 0; i < resolved_threads(options.num_threads); ++i) detectors_.emplace_back(options.detector);
  }

  std::vector<SourceFrame> read(FrameSource& source) {
    std::vector<SourceFrame> batch;
    while (batch.size() < kFramesPerThread * detectors_.size()) {
      std::optional<SourceFrame> frame = source.next();
      if (!frame) break;
      check_resolution_(*frame);
      batch.push_back(std::move(*frame));
    }
    return batch;
  }

  std::vector<DetectedFrame> detect(const std::vector<SourceFrame>& batch) {
    std::vector<DetectedFrame> detected;
    for (const SourceFrame& frame : batch) detected.push_back({frame, {}});
    parallel_for_(detectors_.size(), [&](std::size_t thread) {
      for (std::size_t i = thread; i < batch.size(); i += detectors_.size())
        if (batch[i].is_readable()) detect(detectors_[thread], detected[i]);
    });
    return detected;
  }

 private:
  static void detect(Detector& detector, DetectedFrame& frame) {
    const auto start = std::chrono::steady_clock::now();
    frame.detections = detector.detect(frame.source.pixels.view());
    frame.latency_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }

  ResolutionCheck check_resolution_;
  ParallelFor parallel_for_;
  std::deque<Detector> detectors_;
};

/// Counts a frame; keeps the first one that is unreadable, with its cause.
void count(const SourceFrame& frame, FrameCounts& counts, std::string& first_unreadable) {
  if (frame.is_readable()) {
    ++counts.readable;
  } else if (counts.unreadable++ == 0) {
    first_unreadable = frame.name + ": " + frame.error;
  }
}

void tell(const FrameSource& source, const FrameCounts& counts, const std::string& first_unreadable,
          const Console& console) {
  if (counts.readable == 0 && !counts.is_interrupted) {
    throw io_error(source.name(), counts.unreadable == 0
                                      ? "has no frames"
                                      : fmt::format("none of its {} frames can be read; the first: {}",
                                                    counts.unreadable, first_unreadable));
  }
  if (counts.unreadable > 0) {
    console.warning(fmt::format("{} of {} frames cannot be read; the first: {}", counts.unreadable,
                                counts.readable + counts.unreadable, first_unreadable));
  }
  if (counts.is_interrupted) console.warning(kInterrupted);
}

}  // namespace

FrameCounts detect_frames(FrameSource& source, const FrameLoopOptions& options, const Console& console,
                          const std::function<void(DetectedFrame)>& sink) {
  BatchDetector detector(options);
  FrameCounts counts;
  std::string first_unreadable;
  {
    Progress progress(console, options.label, source.num_frames());
    while (!(counts.is_interrupted = is_interrupted())) {
      const std::vector<SourceFrame> batch = detector.read(source);
      if (batch.empty()) break;
      for (DetectedFrame& frame : detector.detect(batch)) {
        count(frame.source, counts, first_unreadable);
        sink(std::move(frame));
      }
      progress.advance(batch.size());
    }
  }
  tell(source, counts, first_unreadable, console);
  return counts;
}

}  // namespace apriltrack::app
