#pragma once

#include <vector>

#include "uncertainty/pose_information.h"

namespace apriltrack {

/// Standard deviations are never taken for smaller than a tenth of those expected.
inline constexpr double kMinScale = 0.1;

/// How large the errors behind the residuals are, in the units of LinearView.
struct ErrorScale {
  /// Of the residuals' noise, times how much neighbouring frames repeat it, and blocks of them: what the
  /// inverse of the normal equations is to be multiplied by.
  double noise_variance = 1.0;
  /// Of the errors that each tag keeps in all of its views (LinearView::by_error).
  double bias_variance = 0.0;
  /// How much neighbouring frames repeat it: views per view whose errors are its own (noise_correlation.h,
  /// block_scatter.h).
  double views_per_independent_view = 1.0;
};

/// From the residuals that are left, with what was expected: a scaled inverse chi-squared prior at 1 for the
/// noise, at `expected_bias_variance` for what tags keep (docs/algorithms/calibration.md, equations 8 to 11).
/// views: linearised where the adjustment ended, in the order of time; `poses` is made from them.
ErrorScale error_scale(const std::vector<LinearView>& views, const PoseInformation& poses,
                       double expected_bias_variance);

/// Of the gradient of such parameters, by noise and by the errors that tags keep.
Eigen::MatrixXd gradient_covariance(const ParameterInformation& parameters, const ErrorScale& scale);

}  // namespace apriltrack
