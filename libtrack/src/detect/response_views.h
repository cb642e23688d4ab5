#pragma once

#include <span>
#include <string>
#include <vector>

#include "apriltrack/base/parallel.h"
#include "apriltrack/detect/estimate_response.h"
#include "coded_tag.h"

namespace apriltrack {

/// A picture of a tag, in a frame.
struct ResponseView {
  CodedTag view;
  TagKey tag;
  double half_size_m = 0.0;
  int frame = 0;  ///< Of those that are looked at, in the order of time.
};

/// Sharp pictures of tags from frames spread evenly over all, fitted with `first`.
std::vector<ResponseView> response_views(std::span<const FrameDetections> frames,
                                         const ResponseCamera& camera, const TagSizes& sizes,
                                         const CodeCurve& first, std::size_t most_pictures,
                                         const ParallelFor& parallel);

}  // namespace apriltrack
