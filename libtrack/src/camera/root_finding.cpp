#include "root_finding.h"

namespace apriltrack {
namespace {

/// Sign changes of the polynomial in (0, limit), in rising order. Between neighbouring roots of the
/// derivative the polynomial is monotonic, so that bisection finds every change of sign; the recursion ends
/// at a constant.
std::vector<double> sign_changes(const Polynomial& polynomial, double limit) {
  if (polynomial.size() <= 1) return {};
  std::vector<double> ends = sign_changes(derivative(polynomial), limit);
  ends.push_back(limit);
  std::vector<double> roots;
  double low = 0.0;
  for (const double high : ends) {
    const bool is_positive_at_low = evaluate(polynomial, low) > 0.0;
    if (is_positive_at_low != (evaluate(polynomial, high) > 0.0)) {
      double a = low;
      double b = high;
      for (double middle = 0.5 * (a + b); middle > a && middle < b; middle = 0.5 * (a + b)) {
        ((evaluate(polynomial, middle) > 0.0) == is_positive_at_low ? a : b) = middle;
      }
      // The end at which the polynomial is not positive: an exact root must not be taken for a positive
      // value.
      roots.push_back(is_positive_at_low ? b : a);
    }
    low = high;
  }
  return roots;
}

}  // namespace

double evaluate(const Polynomial& polynomial, double x) {
  double value = 0.0;
  for (auto coefficient = polynomial.rbegin(); coefficient != polynomial.rend(); ++coefficient) {
    value = value * x + *coefficient;
  }
  return value;
}

Polynomial multiply(const Polynomial& a, const Polynomial& b) {
  Polynomial product(a.size() + b.size() - 1, 0.0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) product[i + j] += a[i] * b[j];
  }
  return product;
}

Polynomial add_scaled(const Polynomial& a, double scale, const Polynomial& b) {
  Polynomial sum = a;
  sum.resize(std::max(a.size(), b.size()), 0.0);
  for (std::size_t i = 0; i < b.size(); ++i) sum[i] += scale * b[i];
  return sum;
}

Polynomial derivative(const Polynomial& polynomial) {
  if (polynomial.size() <= 1) return {0.0};
  Polynomial slope(polynomial.size() - 1);
  for (std::size_t i = 1; i < polynomial.size(); ++i) slope[i - 1] = static_cast<double>(i) * polynomial[i];
  return slope;
}

std::optional<double> first_nonpositive(const Polynomial& polynomial, double limit) {
  // A double root touches zero without a change of sign; it lies at a change of sign of the derivative.
  std::vector<double> candidates = sign_changes(derivative(polynomial), limit);
  const std::vector<double> roots = sign_changes(polynomial, limit);
  candidates.insert(candidates.end(), roots.begin(), roots.end());
  candidates.push_back(limit);
  std::sort(candidates.begin(), candidates.end());
  for (const double x : candidates) {
    if (evaluate(polynomial, x) <= 0.0) return x;
  }
  return std::nullopt;
}

}  // namespace apriltrack
