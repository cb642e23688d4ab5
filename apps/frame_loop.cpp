#include "frame_loop.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "apriltrack/base/error.h"
#include "apriltrack/base/parallel.h"
#include "apriltrack/image/blank.h"
#include "copied_frames.h"

namespace apriltrack::app {
namespace {

constexpr std::size_t kFramesPerThread = 4;  // evens out slow frames; a 2 MP frame takes 2 MB

int resolved_threads(int num_threads) {
  if (num_threads > 0) return num_threads;
  constexpr int kMaxDefaultThreads = 8;  // every detector holds decoding tables of 38 MB (tag36h11)
  return std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, kMaxDefaultThreads);
}

/// Holds every image against the camera's resolution, or, where its file names none, the first readable
/// image's. One of another size among good ones is left out like a corrupt one; images of which none fits
/// have the wrong camera file.
class ResolutionCheck {
 public:
  explicit ResolutionCheck(const Camera* camera) : camera_(camera) {}

  void operator()(SourceFrame& frame) {
    if (!camera_ || !frame.is_readable()) return;
    const int width = frame.pixels.width();
    const int height = frame.pixels.height();
    if (!expected_) expected_ = expected_by(frame);
    if (width == expected_->width && height == expected_->height) {
      some_fit_ = true;
      return;
    }
    if (num_odd_++ == 0) first_odd_ = {width, height, frame.name};
    frame.error = fmt::format("is {} x {} pixels, but {}", width, height, expected_->why);
    frame.pixels = GrayImage();
    if (num_odd_ == kEnoughOdd) check_some_fit();
  }

  /// While it has not seen whether one fits: such frames hold no pixels, and may be kept back.
  bool is_undecided() const { return !some_fit_ && num_odd_ > 0; }

  /// Throws where images could be read, and none fits.
  void check_some_fit() const {
    if (is_undecided()) check_resolution(*camera_, first_odd_.width, first_odd_.height, first_odd_.name);
  }

 private:
  /// A live camera would give such images for ever, and a long video for long.
  static constexpr int kEnoughOdd = 32;

  struct Expected {
    int width = 0;
    int height = 0;
    std::string why;
  };
  struct Odd {
    int width = 0;
    int height = 0;
    std::string name;
  };

  Expected expected_by(const SourceFrame& first) const {
    if (camera_->width != 0 || camera_->height != 0)
      return {camera_->width, camera_->height,
              fmt::format("camera '{}' is calibrated for {} x {}", camera_->name, camera_->width,
                          camera_->height)};
    const int width = first.pixels.width();
    const int height = first.pixels.height();
    return {width, height,
            fmt::format("the first image, {}, is {} x {}, and camera '{}' names no resolution: give it the "
                        "right one",
                        first.name, width, height, camera_->name)};
  }

  const Camera* camera_;
  std::optional<Expected> expected_;
  bool some_fit_ = false;
  int num_odd_ = 0;
  Odd first_odd_;
};

class BatchDetector {
 public:
  explicit BatchDetector(const FrameLoopOptions& options)
      : check_resolution_(options.camera),
        parallel_for_(parallel_for(resolved_threads(options.num_threads))) {
    if (!options.detector) return;
    for (int i = 0; i < resolved_threads(options.num_threads); ++i)
      detectors_.emplace_back(*options.detector);
  }

  /// Goes on until one image fits, so that a wrong camera file is told of before any progress.
  std::vector<SourceFrame> read(FrameSource& source) {
    std::vector<SourceFrame> batch;
    const std::size_t at_once = frames_at_once(source);
    const auto is_full = [&] { return batch.size() >= at_once && !check_resolution_.is_undecided(); };
    while (!is_full() && !is_interrupted()) {
      std::optional<SourceFrame> frame = source.next();
      if (!frame) break;
      check_resolution_(*frame);
      batch.push_back(std::move(*frame));
    }
    check_resolution_.check_some_fit();
    return batch;
  }

  std::vector<DetectedFrame> detect(const std::vector<SourceFrame>& batch) {
    std::vector<DetectedFrame> detected;
    for (const SourceFrame& frame : batch) detected.push_back({frame, {}, {}});
    parallel_for_(detectors_.size(), [&](std::size_t thread) {
      for (std::size_t i = thread; i < batch.size(); i += detectors_.size())
        if (batch[i].is_readable()) detect(detectors_[thread], detected[i]);
    });
    return detected;
  }

 private:
  /// Of a live camera and of a pipe each frame is wanted as soon as it is there.
  std::size_t frames_at_once(const FrameSource& source) const {
    const bool is_recording = source.num_frames().has_value();
    return is_recording ? kFramesPerThread * std::max<std::size_t>(1, detectors_.size()) : 1;
  }
  static void detect(Detector& detector, DetectedFrame& frame) {
    const auto start = std::chrono::steady_clock::now();
    FoundTags found = detector.find(frame.source.pixels.view());
    frame.detections = std::move(found.detections);
    frame.left_out = std::move(found.left_out);
    frame.latency_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }

  ResolutionCheck check_resolution_;
  ParallelFor parallel_for_;
  std::deque<Detector> detectors_;
};

/// What is told of the first frame of a kind.
struct FirstOnes {
  std::string unreadable;  ///< With its cause.
  std::string copy;
};

void count(const DetectedFrame& detected, FrameCounts& counts, FirstOnes& first) {
  const SourceFrame& frame = detected.source;
  if (detected.is_copy && counts.copies++ == 0) first.copy = frame.name;
  if (frame.is_readable()) {
    if (counts.blank == counts.readable && is_blank(frame.pixels.view())) ++counts.blank;
    ++counts.readable;
  } else if (counts.unreadable++ == 0) {
    first.unreadable = frame.name + ": " + frame.error;
  }
}

void tell(const FrameSource& source, const FrameCounts& counts, const FirstOnes& first, std::size_t skip,
          const Console& console) {
  if (counts.readable == 0 && counts.unreadable == 0 && !counts.is_interrupted && skip > 0)
    throw invalid_input("--skip",
                        fmt::format("leaves out {} frames, and {} has no more", skip, source.name()));
  if (counts.readable == 0 && !counts.is_interrupted) {
    throw io_error(source.name(), counts.unreadable == 0
                                      ? "has no frames"
                                      : fmt::format("none of its {} frames can be read; the first: {}",
                                                    counts.unreadable, first.unreadable));
  }
  if (counts.unreadable > 0) {
    console.warning(fmt::format("{} of {} frames are left out; the first: {}", counts.unreadable,
                                counts.readable + counts.unreadable, first.unreadable));
  }
  if (counts.copies > 0) console.warning(told_of_copies(counts.copies, counts.readable, first.copy));
  if (counts.is_interrupted) console.warning(kInterrupted);
}

}  // namespace

nlohmann::json value_range_json(const std::optional<ValueRange>& range) {
  if (!range) return nullptr;
  const std::optional<int> bits = range->bits();
  return {{"black", range->black}, {"white", range->white}, {"bits", bits ? nlohmann::json(*bits) : nullptr}};
}

FrameCounts detect_frames(FrameSource& source, const FrameLoopOptions& options, const Console& console,
                          const std::function<void(DetectedFrame)>& sink) {
  BatchDetector detector(options);
  FrameCounts counts;
  FirstOnes first;
  CopyWatch copies;
  {
    Progress progress(console, options.label, source.num_frames());
    while (!(counts.is_interrupted = is_interrupted())) {
      const std::vector<SourceFrame> batch = detector.read(source);
      if (batch.empty()) break;
      if (is_interrupted()) continue;
      for (DetectedFrame& frame : detector.detect(batch)) {
        if (is_interrupted()) break;
        frame.is_copy = copies.is_copy(frame.source);
        count(frame, counts, first);
        sink(std::move(frame));
        progress.advance();
      }
    }
  }
  counts.value_range = source.value_range();
  tell(source, counts, first, options.skip, console);
  return counts;
}

}  // namespace apriltrack::app
