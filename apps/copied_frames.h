#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "apriltrack/source/frame_source.h"

namespace apriltrack::app {

/// Knows a frame that shows the very pixels of the one before: no camera takes the same noise twice, so that
/// a recorder or a converter has repeated the picture, or an encoder has left out what changed.
class CopyWatch {
 public:
  /// Frame by frame, in order. Pictures of one brightness all over, such as with a covered lens, are no
  /// copies.
  bool is_copy(const SourceFrame& frame);

 private:
  std::optional<std::uint64_t> previous_;  ///< A digest of the pixels.
};

/// "3 of 90 frames are copies of the frame before, ...", for people. Requires that there are some.
std::string told_of_copies(std::size_t copies, std::size_t frames, const std::string& first);

}  // namespace apriltrack::app
