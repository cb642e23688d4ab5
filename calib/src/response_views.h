#pragma once

#include <span>
#include <vector>

#include "apriltrack/base/parallel.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detection.h"
#include "apriltrack/tags/tag_sizes.h"
#include "coded_view.h"

namespace apriltrack {

/// A picture of a tag, in a frame.
struct ResponseView {
  CodedView view;
  TagKey tag;
  int frame = 0;  ///< Of those that are looked at, in the order of time.
};

/// Sharp pictures of tags from frames spread evenly over all, fitted with `first`. camera: must outlive them.
std::vector<ResponseView> response_views(std::span<const FrameDetections> frames, const Camera& camera,
                                         const TagSizes& sizes, const CodeCurve& first,
                                         std::size_t most_pictures, const ParallelFor& parallel);

}  // namespace apriltrack
