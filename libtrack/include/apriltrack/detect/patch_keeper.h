#pragma once

#include <cstddef>
#include <map>

#include "apriltrack/detect/detection.h"
#include "apriltrack/image/image.h"

namespace apriltrack {

/// Chooses the frames of one recording whose pictures of tags are kept (FrameDetections::patches), to bound
/// their memory: every frame at first, every second after 400 kept frames and so on, and always the frames of
/// a tag with fewer than 40 pictures. Of 10,000 frames some 2,000 are kept.
class PatchKeeper {
 public:
  /// Frame by frame, in order: fills in frame.patches from its image, if this frame is chosen.
  void keep(const GrayView& image, FrameDetections& frame);

 private:
  bool is_wanted(const FrameDetections& frame) const;

  std::size_t num_seen_ = 0;
  std::size_t num_kept_ = 0;
  std::map<TagKey, std::size_t> kept_of_tag_;
};

}  // namespace apriltrack
