#pragma once

#include <optional>

#include "apriltrack/tags/tag_map.h"

namespace apriltrack {

/// Whether more views are wanted of a tag: few show it, or they leave it loose. by_noise: the part of its
/// covariance that more views would lessen. constrained: what is left of all of it where something was
/// measured beside the images.
bool is_weak(const MapTag& tag, int views, const std::optional<Matrix6d>& by_noise,
             const std::optional<Matrix6d>& constrained);

/// Adds the flag, or takes it away; others stay.
void flag_weak(bool is_weak, TagStatistics& statistics);

}  // namespace apriltrack
