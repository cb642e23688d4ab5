#pragma once

#include <span>

namespace apriltrack {

/// Root of the mean square; NaN when there are no values.
double root_mean_square(std::span<const double> values);
double mean(std::span<const double> values);
/// The mean of the two middle values when their number is even; NaN when there are none.
double median(std::span<const double> values);

/// fraction in [0, 1]; between two values, linearly by rank: (n - 1) * fraction (Hyndman and Fan 1996,
/// definition 7, what numpy calls "linear"). NaN when there are no values.
double percentile(std::span<const double> values, double fraction);

/// The decimal number with `decimals` places that is nearest to the double's exact value; to even in a tie.
double round_to_decimals(double value, int decimals);

}  // namespace apriltrack
