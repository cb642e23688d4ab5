#pragma once

#include <cstddef>
#include <map>

#include "apriltrack/detect/detection.h"

namespace apriltrack::app {

/// Keeps pictures of the tags of one recording, frame by frame: of every frame at first, of fewer and fewer
/// as there are many, and of tags that were seldom seen in any case. A film of 10,000 frames keeps some
/// 2,000.
class PatchKeeper {
 public:
  /// Cuts the frame's detections out of its image, where they are wanted.
  void keep(const GrayView& image, FrameDetections& frame);

 private:
  bool is_wanted(const FrameDetections& frame) const;

  std::size_t num_seen_ = 0;
  std::size_t num_kept_ = 0;
  std::map<TagKey, std::size_t> kept_of_tag_;
};

}  // namespace apriltrack::app
