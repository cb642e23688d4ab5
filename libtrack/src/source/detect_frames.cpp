#include "apriltrack/source/detect_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "apriltrack/base/error.h"
#include "apriltrack/detect/batch_detector.h"
#include "apriltrack/image/blank.h"
#include "apriltrack/source/copied_frames.h"

namespace apriltrack {
namespace {

constexpr std::size_t kFramesPerThread = 4;  // evens out slow frames; a 2 MP frame takes 2 MB

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

class FrameLoop {
 public:
  explicit FrameLoop(const DetectFramesOptions& options)
      : check_resolution_(options.camera), should_stop_(options.should_stop) {
    if (options.detector) detector_.emplace(*options.detector, options.num_threads);
  }

  /// Goes on until one image fits, so that a wrong camera file is told of before any progress.
  std::vector<SourceFrame> read(FrameSource& source) {
    std::vector<SourceFrame> batch;
    const std::size_t at_once = frames_at_once(source);
    const auto is_full = [&] { return batch.size() >= at_once && !check_resolution_.is_undecided(); };
    while (!is_full() && !asks_to_stop(should_stop_)) {
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
    if (!detector_) return detected;
    std::vector<GrayView> images;
    for (const SourceFrame& frame : batch)
      images.push_back(frame.is_readable() ? frame.pixels.view() : GrayView());
    std::vector<BatchDetector::Found> found = detector_->find(images);
    for (std::size_t i = 0; i < batch.size(); ++i) {
      detected[i].detections = std::move(found[i].tags.detections);
      detected[i].left_out = std::move(found[i].tags.left_out);
      detected[i].latency_s = found[i].latency_s;
    }
    return detected;
  }

 private:
  /// Of a live camera and of a pipe each frame is wanted as soon as it is there.
  std::size_t frames_at_once(const FrameSource& source) const {
    const bool is_recording = source.num_frames().has_value();
    return is_recording ? kFramesPerThread * (detector_ ? detector_->num_threads() : 1) : 1;
  }

  ResolutionCheck check_resolution_;
  const ShouldStop& should_stop_;
  std::optional<BatchDetector> detector_;
};

void count(const DetectedFrame& detected, FrameCounts& counts) {
  const SourceFrame& frame = detected.source;
  if (detected.is_copy && counts.copies++ == 0) counts.first_copy = frame.name;
  if (frame.is_readable()) {
    if (counts.blank == counts.readable && is_blank(frame.pixels.view())) ++counts.blank;
    ++counts.readable;
  } else if (counts.unreadable++ == 0) {
    counts.first_unreadable = frame.name + ": " + frame.error;
  }
}

void check_some_readable(const FrameSource& source, const FrameCounts& counts, std::size_t skip) {
  if (counts.readable > 0 || counts.is_interrupted) return;
  if (counts.unreadable == 0 && skip > 0)
    throw invalid_input("--skip",
                        fmt::format("leaves out {} frames, and {} has no more", skip, source.name()));
  throw io_error(source.name(), counts.unreadable == 0
                                    ? "has no frames"
                                    : fmt::format("none of its {} frames can be read; the first: {}",
                                                  counts.unreadable, counts.first_unreadable));
}

}  // namespace

std::vector<std::string> FrameCounts::warnings() const {
  std::vector<std::string> all;
  if (unreadable > 0)
    all.push_back(fmt::format("{} of {} frames are left out; the first: {}", unreadable,
                              readable + unreadable, first_unreadable));
  if (copies > 0) all.push_back(message_of_copies(copies, readable, first_copy));
  return all;
}

FrameCounts detect_frames(FrameSource& source, const DetectFramesOptions& options,
                          const std::function<void(DetectedFrame)>& sink) {
  FrameLoop loop(options);
  FrameCounts counts;
  CopyWatch copies;
  {
    const ProgressStep advance = begin_progress(options.progress, options.task, source.num_frames());
    while (!(counts.is_interrupted = asks_to_stop(options.should_stop))) {
      const std::vector<SourceFrame> batch = loop.read(source);
      if (batch.empty()) break;
      if (asks_to_stop(options.should_stop)) continue;
      for (DetectedFrame& frame : loop.detect(batch)) {
        if (asks_to_stop(options.should_stop)) break;
        frame.is_copy = copies.is_copy(frame.source);
        count(frame, counts);
        sink(std::move(frame));
        advance();
      }
    }
  }
  counts.value_range = source.value_range();
  check_some_readable(source, counts, options.skip);
  return counts;
}

}  // namespace apriltrack
