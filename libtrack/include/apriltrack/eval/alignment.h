#pragma once

#include <optional>
#include <span>

#include "apriltrack/geometry/pose.h"

namespace apriltrack {

/// How much orientations count in an alignment of tags beside positions that are scaled to unit spread:
/// little, but enough to settle the rotation when there is one tag, or when all stand on a line.
inline constexpr double kMapOrientationWeight = 0.01;

/// The rigid motion T_reference_estimate, without scale, that brings `estimate` nearest to `reference` in the
/// least squares sense (Umeyama, PAMI 1991); pairs have equal indices.
///
/// orientation_weight: 0 for positions alone; else orientations take part with this weight, the positions
/// being divided by their root mean square distance from their centre. Requires as many poses on either side,
/// at least one. nullopt when the poses do not settle the rotation (with weight 0: fewer than three
/// positions, or all on one line).
std::optional<Pose> align_rigidly(std::span<const Pose> reference, std::span<const Pose> estimate,
                                  double orientation_weight);

}  // namespace apriltrack
