#pragma once

#include <Eigen/Core>
#include <vector>

#include "apriltrack/image/image.h"

namespace apriltrack {

/// The blur of the lens: a Gaussian between the pixels, not at the pixels alone.
///
/// What it blurs, the mean over a pixel's area about any point, is asked for at the points p + offset + n of
/// a rank-1 lattice, n whole pixels and one offset per look, and summed with the Gaussian's values there. A
/// look is a picture of all pixels with one offset, so that its neighbours serve as points too: each look by
/// itself is blurred and in place, and the looks can share the exposure among them. What a step of light
/// shows is within 0.11 % of the closed form from sigma_px = 0.2 on (docs/algorithms/simulation.md, section
/// 5).
class Lens {
 public:
  /// sigma_px: 0, or from 0.2 on. 0: one look, with no offset, that stays as it is.
  explicit Lens(double sigma_px);

  int num_looks() const { return static_cast<int>(looks_.size()); }
  /// Where a look sees its pixels: that far from their centres, less than half a pixel each way. Looks
  /// 0, 1, ... follow each other in time: neither offsets nor weights go with it.
  const Eigen::Vector2f& offset_px(int look) const {
    return looks_[static_cast<std::size_t>(look)].offset_px;
  }

  /// Adds a look's share: looks of an even picture, one each, add up to that picture. Light beyond the
  /// image's border is taken as the border's.
  void add(const Image<float>& seen, int look, Image<float>& blurred) const;

 private:
  struct Look {
    Eigen::Vector2f offset_px = Eigen::Vector2f::Zero();
    std::vector<float> across;  ///< Weights of pixels -reach ... reach of a row.
    std::vector<float> down;
  };

  std::vector<Look> looks_;
};

}  // namespace apriltrack
