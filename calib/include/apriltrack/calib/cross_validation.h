#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "apriltrack/tags/tag_key.h"

namespace apriltrack {

/// How the two maps of the halves of a recording differ in one tag, both with the same tag held.
struct HalvesOfTag {
  TagKey tag;
  double difference_m = 0.0, difference_rad = 0.0;
  double sigma_m = 0.0, sigma_rad = 0.0;  ///< What the halves' covariances expect of the difference.
  /// Square of the difference in units of its covariance, over 6: 1 where the covariances tell the truth.
  double normalised_error_squared = 0.0;
};

/// A recording cut into two halves, blocks of neighbouring moments by turns, and a map made from each.
struct CrossValidation {
  std::string why_not;            ///< Where the halves cannot be solved; all else is empty then.
  TagKey held_tag;                ///< Of both halves.
  std::vector<HalvesOfTag> tags;  ///< That both halves have; without the held one.
  int moments_of_first = 0, moments_of_second = 0;
  /// Of all tags together, over the number of unknowns, so that it depends on no gauge: 1 where covariances
  /// tell the truth; above 2 they claim too much.
  double normalised_error_squared = 0.0;
  std::string words;

  /// Above 2, and by more than three standard deviations of chance above 1 (few tags scatter).
  bool is_in_doubt() const {
    const double unknowns = 6.0 * static_cast<double>(tags.size());
    return normalised_error_squared > 2.0 && normalised_error_squared > 1.0 + 3.0 * std::sqrt(2.0 / unknowns);
  }
};

}  // namespace apriltrack
