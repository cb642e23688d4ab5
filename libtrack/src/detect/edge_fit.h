#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace apriltrack {

/// The ideal picture across an edge, before any blur: levels 0 (the border's own, just inside the edge) to 1
/// (just outside), changing by `height[i]` at `position_px[i]`. The edge itself is one of the changes: at 0,
/// by +1.
struct EdgeProfile {
  static constexpr int kMaxChanges = 6;
  double innermost_level = 0.0;
  int num_changes = 0;
  std::array<double, kMaxChanges> position_px{};  ///< Across the assumed edge, outwards positive.
  std::array<double, kMaxChanges> height{};
};

/// Light at one point near an edge.
struct EdgeSample {
  double along = 0.0;   ///< Place along the assumed edge, -1 at its start and 1 at its end.
  double across = 0.0;  ///< Pixels from the assumed edge, outwards positive.
  double light = 0.0;
  std::size_t profile = 0;  ///< Index of the profile that holds here: one for each place along the edge.
};

/// Where a blurred edge really lies: `offset_px(along)` pixels outside the assumed one.
struct FittedEdge {
  double offset = 0.0;
  double slope = 0.0;
  double bend = 0.0;
  double sigma_px = 0.0;  ///< Of the blur across the edge, the pixel's own included.
  double inner_light = 0.0;
  double outer_light = 0.0;
  double inner_tilt = 0.0;  ///< Of the levels, from the middle of the edge to its end.
  double outer_tilt = 0.0;
  double residual_rms = 0.0;     ///< Over the contrast |outer - inner|, outliers weighted down.
  double sigma_offset_px = 0.0;  ///< Standard error of `offset`.

  double offset_px(double along) const { return offset + slope * along + bend * (along * along - 1.0 / 3.0); }
};

struct EdgeFitOptions {
  double initial_sigma_px = 1.0;
  /// Standard deviation of `bend` before the samples are looked at; what a lens does to an edge of this
  /// length.
  double bend_prior_px = 0.1;
  /// Sign of outer minus inner light: +1 for a black border on white.
  double polarity = 1.0;
  /// The same edge as found about another line: begun there, the fit needs half the steps.
  std::optional<FittedEdge> before = std::nullopt;
};

/// Fits light = inner + (outer - inner) * P((across - offset_px(along)) / sigma), P the profile blurred by a
/// normal distribution, both levels linear in `along`, robustly (Gauss-Newton with Geman-McClure weights).
/// nullopt when there is no edge of the right polarity or the offset is not determined. samples: those of a
/// profile side by side.
std::optional<FittedEdge> fit_edge(const std::vector<EdgeSample>& samples,
                                   const std::vector<EdgeProfile>& profiles, const EdgeFitOptions& options);

}  // namespace apriltrack
