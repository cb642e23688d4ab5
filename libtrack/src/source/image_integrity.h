#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace apriltrack {

/// The kinds that are read. OpenCV has decoders of some more, which no camera needs and few have tried with
/// files that lie.
enum class ImageKind { kUnknown, kPng, kJpeg, kBmp, kTiff, kWebp, kPnm };

struct ClaimedSize {
  std::int64_t width = 0;
  std::int64_t height = 0;
};

/// What the bytes of an image file say of themselves, without decoding them.
struct ImageIntegrity {
  ImageKind kind = ImageKind::kUnknown;
  /// Any number that the file holds, also 0 and below; none of WebP, whose decoder lets 16383 x 16383 pass
  /// at most.
  std::optional<ClaimedSize> size = std::nullopt;
  int bits_per_sample = 0;  ///< Of a PNG; 0 of others.
  /// Number that stands for white in a PNM file; 0 where the decoder knows it.
  int full_scale = 0;
  std::string damage = {};  ///< Empty when nothing is wrong.
};

/// Looks for the end that a whole file must have. Needed because decoders hand out the upper part of a cut
/// JPEG over grey, as if all were well: the file of a camera that lost its power must not pass for a picture
/// of nothing.
ImageIntegrity inspect_image(std::string_view bytes);

/// A PNG file without the chunks that do not matter to the pixels: of odd colour profiles and their like
/// libpng talks to stderr. Of whole files, as inspect_image() finds them.
std::string picture_of_png(std::string_view bytes);

}  // namespace apriltrack
