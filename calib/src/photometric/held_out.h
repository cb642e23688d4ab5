#pragma once

#include <optional>
#include <vector>

#include "photometric/photometric_adjustment.h"

namespace apriltrack {

/// What pictures that were held out disagree by with two maps, in standard deviations: root mean square, per
/// number.
struct HeldOutComparison {
  double before = 0.0, after = 0.0;
  /// What the squares of a moment fall by in the mean, over the standard error of that: moments are
  /// independent, pictures of one are not. By Student's distribution of moments - 1 degrees of freedom where
  /// the maps are as good as each other.
  double gain_in_errors = 0.0;
  int moments = 0;             ///< That are held out, and explained before.
  std::vector<int> lost_tags;  ///< Most of whose pictures the map explains before, and no more after.
};

/// Of the pictures that are explained before: one that is not explained after counts there as if it were just
/// not an outlier. nullopt where none is explained by both. before, after:
/// PhotometricAdjustment::disagreements2() of the scene's views.
std::optional<HeldOutComparison> compare_held_out(const std::vector<PhotometricView>& views,
                                                  const std::vector<std::optional<double>>& before,
                                                  const std::vector<std::optional<double>>& after);

}  // namespace apriltrack
