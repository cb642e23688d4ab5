#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apriltrack/base/progress.h"
#include "apriltrack/base/should_stop.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detector.h"
#include "apriltrack/source/frame_source.h"

namespace apriltrack {

struct DetectFramesOptions {
  std::optional<DetectorOptions> detector = std::nullopt;  ///< nullopt: frames are only read.
  /// The images must have this camera's resolution, or the first image's where the camera names none.
  /// nullptr: any size.
  const Camera* camera = nullptr;
  int num_threads = 0;          ///< As for BatchDetector.
  std::size_t skip = 0;         ///< Frames that the source left out at its start (SourceOptions::skip).
  std::string task = "detect";  ///< What `progress` is told of.
  ProgressSink progress = {};   ///< A step for each frame.
  ShouldStop should_stop = {};
};

/// One frame and the tags found in it: none in a frame that is unreadable, or without a detector.
struct DetectedFrame {
  const SourceFrame& source;
  std::vector<Detection> detections;
  std::vector<LeftOutTag> left_out;
  bool is_copy = false;  ///< It has exactly the pixels of the frame before (CopyWatch).
  double latency_s =
      0.0;  ///< From the decoded image to the detections, with other threads at work beside it.
};

struct FrameCounts {
  std::size_t readable = 0;
  std::size_t unreadable = 0;
  std::size_t copies = 0;       ///< Readable frames with is_copy.
  std::size_t blank = 0;        ///< Readable frames with is_blank(), until the first one that is not.
  bool is_interrupted = false;  ///< should_stop ended the loop.
  std::optional<ValueRange> value_range = std::nullopt;  ///< Of 16-bit image files.
  std::string first_unreadable = {};                     ///< Name and cause of the first unreadable frame.
  std::string first_copy = {};                           ///< Name of the first copy.

  bool are_all_blank() const { return readable > 0 && blank == readable; }
  /// For people: that frames are left out as unreadable, or are copies.
  std::vector<std::string> warnings() const;
};

/// Detects in every frame of `source`, several frames side by side, each thread with a detector of its own;
/// `sink` gets all frames one by one, in order, so that the number of threads changes no result.
///
/// should_stop ends it before the next frame; frames that `sink` has not had by then are dropped. Throws
/// Error(kIo) when no frame can be read, Error(kInvalidInput) when no image has the camera's resolution (one
/// odd image among others is left out, and counted as unreadable) or when the source skipped all frames.
FrameCounts detect_frames(FrameSource& source, const DetectFramesOptions& options,
                          const std::function<void(DetectedFrame)>& sink);

}  // namespace apriltrack
