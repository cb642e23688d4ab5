#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace apriltrack {

/// At a lens model's fold a pixel has no slope by which to find its ray; this far inside it has one of 1e-4,
/// enough for 1e-9 px.
inline constexpr double kInsideFold = 1.0 - 1e-4;

/// Coefficients from the constant term upwards.
using Polynomial = std::vector<double>;

double evaluate(const Polynomial& polynomial, double x);
Polynomial multiply(const Polynomial& a, const Polynomial& b);
/// a + scale * b
Polynomial add_scaled(const Polynomial& a, double scale, const Polynomial& b);
Polynomial derivative(const Polynomial& polynomial);

/// Smallest x in (0, limit] with polynomial(x) <= 0, given polynomial(0) > 0; nullopt when there is none.
std::optional<double> first_nonpositive(const Polynomial& polynomial, double limit);

/// x in [low, high] with function(x) = target, to rounding error, for a function that rises from at most
/// target at low to at least target at high. function: double -> double; slope: its derivative.
///
/// Newton steps, each of which must be at most half the step before the last; otherwise, or where one would
/// leave the bracket, the bracket is halved: near a fold the slope vanishes and Newton alone would jump
/// about.
template <class Function, class Slope>
double solve_rising(const Function& function, const Slope& slope, double target, double low, double high,
                    double start) {
  double x = std::clamp(start, low, high);
  double last_step = high - low;
  double step_before_last = 2.0 * (high - low);
  for (int i = 0; i < 200; ++i) {
    const double residual = function(x) - target;
    if (residual == 0.0) break;
    (residual < 0.0 ? low : high) = x;
    const double newton = x - residual / slope(x);
    const bool is_good = newton >= low && newton <= high && std::abs(newton - x) <= 0.5 * step_before_last;
    const double next = is_good ? newton : 0.5 * (low + high);
    if (next == x || (!is_good && (next == low || next == high))) break;
    step_before_last = last_step;
    last_step = std::abs(next - x);
    x = next;
  }
  return x;
}

}  // namespace apriltrack
