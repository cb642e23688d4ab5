#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "apriltrack/detect/detection.h"

namespace apriltrack {

/// A tag in one camera's frame; cameras and tags are numbered as the caller likes, from 0.
struct TagSight {
  int camera = 0;
  int tag = 0;
  std::array<Eigen::Vector2d, kNumCorners> corners_px;  ///< Finite.
};

/// Of each moment, the place from which the rig saw it, numbered from 0 as they come up: the camera stood
/// still, or frames were copied, where several are of one.
///
/// moments: what all cameras showed at one time, each. A moment is of a place when the place has shown more
/// than half of its sights, and over three quarters of these lie where they first did, to `same_place_px`
/// (> 0; rms over a tag's corners). Sights that come and go, and tags that move, make no new place.
std::vector<std::size_t> find_camera_places(std::span<const std::vector<TagSight>> moments,
                                            double same_place_px);

}  // namespace apriltrack
