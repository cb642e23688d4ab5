#pragma once

#include <vector>

#include "numerics/linear_view.h"

namespace apriltrack {

/// How many views of a video are worth one independent view, >= 1.
///
/// Neighbouring frames repeat much of a view's error: the same pixels, the same compression, the same
/// light. The integrated autocorrelation 1 + 2 (r1 + r2 + ...) of each tag's whitened residuals along its
/// views says how much (summed as long as it stays clearly positive, after Geyer, "Practical Markov chain
/// Monte Carlo", 1992). Covariances that take views for independent are to be multiplied by it. What stays
/// constant over a whole recording is not seen: such bias hides in the map. views: in the order of time.
double views_per_independent_view(const std::vector<LinearView>& views);

}  // namespace apriltrack
