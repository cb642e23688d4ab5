#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "apriltrack/image/image.h"

namespace apriltrack {

/// How a frame, or a tag in it, fared; each has a colour of its own in every picture.
enum class FrameOutcome {
  kPoseRight,  ///< A pose within the limit of the picture's caption.
  kPoseWrong,  ///< A pose beyond it.
  kBlind,      ///< Tags in view, and no pose.
  kNoTagInView,
};

struct TimelineFrame {
  double time_s = 0.0;
  double blur_px = 0.0;  ///< Longest path of a visible corner during the exposure.
  FrameOutcome outcome = FrameOutcome::kNoTagInView;
};

struct TagOutline {
  std::array<Eigen::Vector2d, 4> corners_px;
  FrameOutcome outcome = FrameOutcome::kBlind;
};

/// One frame of the recording, shown above the time line.
struct ExampleFrame {
  GrayView image;
  std::vector<TagOutline> outlines;
  std::string caption;
  double time_s = 0.0;
};

/// Draws blur over time, a bar per frame in the colour of its outcome, with example frames above, and writes
/// it as a PNG file. Requires at least one frame. Throws Error(kIo).
void write_detection_timeline(const std::filesystem::path& path, const std::string& title,
                              std::span<const TimelineFrame> frames, std::span<const ExampleFrame> examples);

}  // namespace apriltrack
