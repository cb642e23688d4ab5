#pragma once

#include <cmath>

namespace apriltrack {

/// Neighbouring pixels, or samples of a patch, share the light of a pixel and of the lens blur: so many err
/// as one.
inline constexpr double kPixelsPerIndependentSample = 3.0;
/// The kappa below that the trackers use.
inline constexpr double kUnexplainedVariance = 0.03;

/// Log-likelihood of n independent samples of an image that a template explains with correlation c, after the
/// best gain, offset and noise: -(n / 2) log(1 - c^2 + kappa).
///
/// Samples I_i = g B_i + b + N(0, sigma^2) have log L = -(n / 2) log(2 pi sigma^2) - sum_i r_i^2 / (2
/// sigma^2). Its maximum over sigma is -(n / 2) log(2 pi e var(r)), and over g and b the residuals' least
/// variance is var(r) = (1 - c^2) var(I), so that max log L = -(n / 2) log(1 - c^2) - (n / 2) log(2 pi e
/// var(I)). The last term is the same for every template that the same samples are held against, and is left
/// out.
///
/// kappa > 0: the share of var(I) that no template explains (print, glare, lens), so that one tag seen
/// perfectly does not outweigh all others. c: not below 0 where a negative gain is no view of the tag.
///
/// Two zeros are in use. As it stands, a tag that is not there at all (no samples) is worth 0, and one that
/// should be seen but explains nothing costs (n / 2) log(1 + kappa): the blur tracker (blur_tracker.md,
/// equation 9), whose states differ in the tags that they show. Less profile_log_likelihood(0, n, kappa),
/// that one is worth 0 itself: JointLikelihood (paper_filter.md, equation 15), for which the same tags take
/// part in all hypotheses and what is not seen counts as an unrelated picture would.
inline double profile_log_likelihood(double correlation, double num_samples, double kappa) {
  return -0.5 * num_samples * std::log(1.0 - correlation * correlation + kappa);
}

}  // namespace apriltrack
