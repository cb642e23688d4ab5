#pragma once

#include <cstddef>
#include <optional>
#include <set>
#include <span>

#include "apriltrack/detect/detector.h"
#include "apriltrack/image/image.h"
#include "apriltrack/tags/tag_key.h"

namespace apriltrack {

/// Pictures in which no tag is read, although there are some.
struct OddPictures {
  bool are_mirrored = false;   ///< Left and right are exchanged, as selfie cameras do.
  bool are_inverted = false;   ///< Light and dark are exchanged: light prints on dark, or negatives.
  std::set<TagKey> tags = {};  ///< Read without a corrected bit once the pictures are put right.
  std::size_t pictures = 0;    ///< In which.
};

/// Looks for tags in the mirror image and the negative of `images`, in which few or none were read as they
/// are. detector: of the families that were looked for. nullopt where none are found, or no more than chance
/// reads. One fast search for each image and way: small pictures will do (reduced_copy()).
std::optional<OddPictures> find_odd_pictures(std::span<const GrayImage> images,
                                             const DetectorOptions& detector);

}  // namespace apriltrack
