#pragma once

#include <cstddef>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detection.h"
#include "apriltrack/detect/detector.h"
#include "apriltrack/source/frame_source.h"
#include "console.h"

namespace apriltrack::app {

struct FrameLoopOptions {
  std::optional<DetectorOptions> detector;  ///< None: frames are only read.
  /// Whose resolution the images must have (the first image's where its file names none); nullptr: any.
  const Camera* camera = nullptr;
  int num_threads = 0;   ///< 0: one per core, 8 at most.
  std::string label;     ///< What the progress line says is being done.
  std::size_t skip = 0;  ///< Frames that the source leaves out at its start: perhaps all.
};

/// One frame and the tags found in it: none in a frame that is unreadable, or without a detector.
struct DetectedFrame {
  const SourceFrame& source;
  std::vector<Detection> detections;
  std::vector<LeftOutTag> left_out;
  bool is_copy = false;    ///< Of the frame before, pixel by pixel.
  double latency_s = 0.0;  ///< From the decoded image to the detections, other threads at work beside it.
};

struct FrameCounts {
  std::size_t readable = 0;
  std::size_t unreadable = 0;
  std::size_t copies = 0;  ///< Readable ones with the very pixels of the frame before (copied_frames.h).
  std::size_t blank = 0;   ///< Readable ones that show nothing, until the first that shows something.
  bool is_interrupted = false;
  std::optional<ValueRange> value_range = std::nullopt;  ///< Of 16-bit image files.

  bool are_all_blank() const { return readable > 0 && blank == readable; }
};

/// Null, or {"black", "white", "bits"}; bits: null where the range is none of so many bits.
nlohmann::json value_range_json(const std::optional<ValueRange>& range);

/// Detects in every frame of `source`, several side by side, each thread with a detector of its own; `sink`
/// gets all frames one by one, in order, so that the number of threads changes no result.
///
/// Ctrl-C ends it before the next frame, and what `sink` has not had by then is dropped. It warns of that, of
/// unreadable frames and of copies before it returns, so that users hear the cause before what follows from
/// it. Throws Error(kIo) when no frame can be read, Error(kInvalidInput) when no image has the camera's
/// resolution (one of many is left out and counted as unreadable).
FrameCounts detect_frames(FrameSource& source, const FrameLoopOptions& options, const Console& console,
                          const std::function<void(DetectedFrame)>& sink);

}  // namespace apriltrack::app
