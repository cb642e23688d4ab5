#pragma once

#include <optional>

#include "apriltrack/image/image.h"
#include "apriltrack/tags/tag_key.h"

namespace apriltrack {

struct Detection;

/// The part of an image that shows one tag, as it came from the camera.
struct TagPatch {
  TagKey tag;
  int x = 0;  ///< Of the image: column and row of the patch's first pixel.
  int y = 0;
  GrayImage pixels;
};

/// What a detection was found in: all printed cells of its tag, and some pixels about them, as far as the
/// image goes. nullopt for corners that are not finite, a family that is not known, or a tag outside the
/// image.
std::optional<TagPatch> cut_patch(const GrayView& image, const Detection& detection);

}  // namespace apriltrack
