#pragma once

#include <optional>
#include <vector>

#include "tag_covariance.h"

namespace apriltrack {

/// Standard deviations are never taken for smaller than a tenth of those expected.
inline constexpr double kMinScale = 0.1;

/// Two shares: noise, scaled by what the residuals show of it (a scaled inverse chi-squared prior at the
/// expected sigma) and by how much neighbouring frames repeat it; and errors that each tag keeps in all of
/// its views, which the fit hides from the residuals. (docs/algorithms/calibration.md, equations 7 to 11.)
///
/// views: linearised where the adjustment ended, in the order of time. bias_variance: of those errors, in the
/// units of LinearView::by_error. nullopt when the views leave a pose undetermined.
std::optional<std::vector<TagCovariance>> scaled_covariances(const std::vector<LinearView>& views,
                                                             const std::vector<int>& tags, int held_tag,
                                                             double bias_variance);

}  // namespace apriltrack
