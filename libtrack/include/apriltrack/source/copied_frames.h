#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "apriltrack/source/frame_source.h"

namespace apriltrack {

/// Recognises a frame with exactly the pixels of the frame before. No camera takes the same noise twice, so a
/// recorder or a converter has repeated the picture, or an encoder has dropped what changed.
class CopyWatch {
 public:
  /// Frame by frame, in order. Blank images (is_blank()), as with a covered lens, are not copies; unreadable
  /// frames are passed over.
  bool is_copy(const SourceFrame& frame);

 private:
  std::optional<std::uint64_t> previous_;  ///< A digest of the pixels.
};

/// For people: "3 of 90 frames are copies of the frame before, ...". copies: at least 1; first: name of the
/// first one.
std::string message_of_copies(std::size_t copies, std::size_t frames, const std::string& first);

}  // namespace apriltrack
