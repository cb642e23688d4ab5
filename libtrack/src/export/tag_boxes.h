#pragma once

#include <Eigen/Core>
#include <vector>

#include "apriltrack/tags/tag_map.h"

namespace apriltrack {

/// A thin box in a tag's frame, metres.
struct TagBox {
  Eigen::Vector3d centre;
  Eigen::Vector3d size;
  bool is_black = true;
};

/// What a printed tag looks like, of boxes: a white sheet, and black bars whose front faces lie in the tag's
/// plane. Edges stay as sharp as the print's in any simulator, where textures would be smoothed.
std::vector<TagBox> boxes_of(const MapTag& tag);

}  // namespace apriltrack
