#pragma once

#include <optional>
#include <vector>

#include "map_state.h"

namespace apriltrack {

/// Covariances of the tags' poses (right perturbation, [translation; rotation]) relative to `held_tag`, for
/// residuals of unit variance once whitened; in the order of part.tags, the held tag's all zero.
///
/// The frames' poses are eliminated block by block (Schur complement), and only the system of the tags is
/// inverted: what ceres::Covariance gives, at a cost that a thousand frames do not raise. nullopt when the
/// views leave a pose undetermined.
std::optional<std::vector<Matrix6d>> tag_covariances(const Observations& observations, const Part& part,
                                                     int held_tag, const MapState& state);

}  // namespace apriltrack
