#include "response_fit.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace apriltrack {
namespace {

constexpr double kLowestExponent = 0.3, kHighestExponent = 4.5;
constexpr int kMostResponseRounds = 25;
constexpr int kRoundsOfNoise = 4;  // it is measured anew in so many, and kept then
constexpr double kMostRoundStep = 0.4;
constexpr double kSettledStep = 2e-4;
/// How far ink may run beyond a cell's edge, or stay behind it, on all of a user's tags.
constexpr double kPrintSigma_m = 5e-5;
constexpr int kBlocksOfFilm = 8;

using Equations = std::vector<CodedView::Equation>;

/// Takes out views that cannot follow.
Equations settle_all(std::vector<ResponseView>& views, const CodeCurve& curve, bool measures_noise,
                     const ParallelFor& parallel) {
  std::vector<std::optional<CodedView::Equation>> all(views.size());
  parallel(views.size(), [&](std::size_t i) {
    all[i] = views[i].view.settle(curve);
    if (all[i] && measures_noise) views[i].view.measure_noise();
  });
  Equations equations;
  std::vector<ResponseView> kept;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!all[i]) continue;
    equations.push_back(*all[i]);
    kept.push_back(std::move(views[i]));
  }
  views = std::move(kept);
  return equations;
}

/// Of the sum of g, by what each group pulls as a whole.
template <class GroupOf>
double pull_variance(const Equations& equations, const GroupOf& group_of) {
  std::map<decltype(group_of(0)), double> pulls;
  for (std::size_t i = 0; i < equations.size(); ++i) pulls[group_of(i)] += equations[i].g;
  if (pulls.size() < 2) return 0.0;
  double sum = 0.0;
  for (const auto& [group, pull] : pulls) sum += pull * pull;
  const auto count = static_cast<double>(pulls.size());
  return sum * count / (count - 1.0);
}

double sigma_of(const Equations& equations, const std::vector<ResponseView>& views) {
  double h = 0.0, by_print = 0.0;
  int last_frame = 0;
  for (const CodedView::Equation& one : equations) {
    h += one.h;
    by_print += one.by_print;
  }
  for (const ResponseView& view : views) last_frame = std::max(last_frame, view.frame);
  const double of_tags = pull_variance(equations, [&](std::size_t i) { return views[i].tag; });
  const double of_blocks = pull_variance(
      equations, [&](std::size_t i) { return views[i].frame * kBlocksOfFilm / (last_frame + 1); });
  const double variance = std::max({h, of_tags, of_blocks});
  return std::sqrt(variance + by_print * by_print * kPrintSigma_m * kPrintSigma_m) / h;
}

}  // namespace

std::optional<FittedExponent> fit_exponent(std::vector<ResponseView>& views, double first,
                                           const ParallelFor& parallel) {
  double exponent = first;
  for (int round = 0; round < kMostResponseRounds; ++round) {
    const CodeCurve curve = CodeCurve::gamma(exponent);
    const Equations equations = settle_all(views, curve, round < kRoundsOfNoise, parallel);
    double h = 0.0, g = 0.0;
    for (const CodedView::Equation& one : equations) {
      h += one.h;
      g += one.g;
    }
    if (!(h > 0.0)) return std::nullopt;
    const double step = std::clamp(g / h, -kMostRoundStep, kMostRoundStep);
    exponent += step;
    if (!(exponent > kLowestExponent && exponent < kHighestExponent)) return std::nullopt;
    if (round >= kRoundsOfNoise && std::abs(step) < kSettledStep)
      return FittedExponent{exponent, sigma_of(equations, views)};
  }
  return std::nullopt;
}

double sigmas_worse(const std::vector<ResponseView>& views, const CodeCurve& other, const CodeCurve& curve,
                    const ParallelFor& parallel) {
  std::vector<std::optional<double>> excess(views.size());
  parallel(views.size(), [&](std::size_t i) {
    CodedView with_other = views[i].view, with_curve = views[i].view;
    if (!with_other.begin(other) || !with_curve.begin(curve)) return;
    const auto cost_other = with_other.settle(other), cost_curve = with_curve.settle(curve);
    if (cost_other && cost_curve) excess[i] = cost_other->cost - cost_curve->cost;
  });
  std::map<int, double> of_frame;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (excess[i]) of_frame[views[i].frame] += *excess[i];
  }
  const auto count = static_cast<double>(of_frame.size());
  if (count < 2.0) return 0.0;
  double sum = 0.0, squares = 0.0;
  for (const auto& [frame, value] : of_frame) sum += value;
  for (const auto& [frame, value] : of_frame) squares += (value - sum / count) * (value - sum / count);
  const double error = std::sqrt(squares / (count - 1.0) / count);
  return sum / count / std::max(error, 1e-9);
}

}  // namespace apriltrack
