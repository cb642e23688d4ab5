#pragma once

#include <optional>
#include <vector>

#include "apriltrack/base/parallel.h"
#include "response_views.h"

namespace apriltrack {

/// The exponent that views have in common.
struct FittedExponent {
  double exponent = 0.0;
  double sigma = 0.0;  ///< See ResponseEstimate.
};

/// Gauss-Newton on the exponent and each view's own unknowns (docs/algorithms/response.md, equations 2 and
/// 3). Views that are no pictures of their tags are taken out. nullopt where it does not settle.
std::optional<FittedExponent> fit_exponent(std::vector<ResponseView>& views, double first,
                                           const ParallelFor& parallel);

/// How much worse `other` explains the views than `curve`, with which they were fitted: in standard errors of
/// the mean over frames, or over views where frames are few.
double sigmas_worse(const std::vector<ResponseView>& views, const CodeCurve& other, const CodeCurve& curve,
                    const ParallelFor& parallel);

}  // namespace apriltrack
