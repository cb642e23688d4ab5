#pragma once

namespace apriltrack {

/// The penalty of Geman and McClure for residuals among which some are of something else: r^2 near zero,
/// never more than reach^2 (S. Geman, D. E. McClure, "Statistical methods for tomographic image
/// reconstruction", Bull. ISI 52(4), 1987).
class GemanMcClure {
 public:
  /// reach: residuals beyond it, in their own unit, pull less the further off they are. Above 0.
  explicit constexpr GemanMcClure(double reach) : reach2_(reach * reach) {}

  /// What takes the place of the squared residual `r2` in a sum of squares.
  constexpr double penalty(double r2) const { return reach2_ * r2 / (reach2_ + r2); }
  /// Of the residual in reweighted least squares: d penalty / d r2, 1 at zero.
  constexpr double weight(double r2) const {
    const double share = reach2_ / (reach2_ + r2);
    return share * share;
  }

 private:
  double reach2_;
};

}  // namespace apriltrack
