#pragma once

#include <optional>
#include <vector>

#include "linear_view.h"

namespace apriltrack {

/// Of a tag's pose (right perturbation, [translation; rotation]), relative to the held tag; all zero for that
/// one itself.
struct TagCovariance {
  /// By residuals that are independent and, once whitened, of unit variance.
  Matrix6d by_noise = Matrix6d::Zero();
  /// By errors that every tag, the held one too, keeps in all of its views: eight numbers per tag, whitened,
  /// independent and of unit variance (S. F. Schmidt's "consider" parameters).
  Matrix6d by_bias = Matrix6d::Zero();
};

/// In the order of `tags`. The frames' poses are eliminated block by block (Schur complement), and only
/// the system of the tags is inverted, a few columns at a time: what ceres::Covariance gives, at a cost that
/// a thousand frames do not raise, with one dense matrix of six rows per tag, and a block for each two tags
/// that a frame shows together. nullopt when the views leave a pose undetermined.
std::optional<std::vector<TagCovariance>> tag_covariances(const std::vector<LinearView>& views,
                                                          const std::vector<int>& tags, int held_tag);

}  // namespace apriltrack
