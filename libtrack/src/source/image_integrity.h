#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace apriltrack {

/// What the bytes of an image file say of themselves, without decoding them.
struct ImageIntegrity {
  std::int64_t width = 0;  ///< 0 when the format is not one of those looked into (PNG, JPEG, PNM, BMP).
  std::int64_t height = 0;
  int bits_per_sample = 0;  ///< Of a PNG; 0 of others.
  /// Number that stands for white in a PNM file; 0 where the decoder knows it.
  int full_scale = 0;
  std::string damage;  ///< Empty when nothing is wrong.
};

/// Looks for the end that a whole file must have. Needed because decoders hand out the upper part of a cut
/// JPEG over grey, as if all were well: the file of a camera that lost its power must not pass for a picture
/// of nothing.
ImageIntegrity inspect_image(std::string_view bytes);

}  // namespace apriltrack
