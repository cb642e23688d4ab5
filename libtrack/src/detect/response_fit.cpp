#include "response_fit.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace apriltrack {
namespace {

constexpr double kLowestExponent = 0.3, kHighestExponent = 4.5;
constexpr int kMostResponseRounds = 25;
constexpr int kRoundsOfNoise = 3;  // it is measured anew in so many, and kept then
constexpr double kMostRoundStep = 0.4;
constexpr double kSettledStep = 1e-3;
/// How far ink may run beyond a cell's edge, or stay behind it, on all of a user's tags.
constexpr double kPrintSigma_m = 5e-5;
constexpr int kBlocksOfFilm = 8;
/// Fewer groups than this tell nothing of how groups scatter.
constexpr std::size_t kLeastGroups = 4;
constexpr std::size_t kManyFrames = 8;

using Equations = std::vector<CodedTag::Equation>;

/// Takes out views that `step` gives none of.
template <class Step>
Equations step_all(std::vector<ResponseView>& views, const Step& step, const ParallelFor& parallel) {
  std::vector<std::optional<CodedTag::Equation>> all(views.size());
  parallel(views.size(), [&](std::size_t i) { all[i] = step(views[i].view); });
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

/// Of the sum of g, by what each group pulls as a whole: as Student's distribution has it, for groups are
/// few.
template <class GroupOf>
double pull_variance(const Equations& equations, const GroupOf& group_of) {
  std::map<decltype(group_of(0)), double> pulls;
  for (std::size_t i = 0; i < equations.size(); ++i) pulls[group_of(i)] += equations[i].g;
  if (pulls.size() < kLeastGroups) return 0.0;
  double sum = 0.0;
  for (const auto& [group, pull] : pulls) sum += pull * pull;
  const auto count = static_cast<double>(pulls.size());
  return sum * count / (count - 3.0);
}

double sigma_of(const Equations& equations, const std::vector<ResponseView>& views) {
  double h = 0.0, by_print = 0.0;
  int last_frame = 0;
  for (std::size_t i = 0; i < equations.size(); ++i) {
    h += equations[i].h;
    by_print += equations[i].by_print / views[i].half_size_m;
    last_frame = std::max(last_frame, views[i].frame);
  }
  const double of_views = pull_variance(equations, [](std::size_t i) { return i; });
  const double of_tags = pull_variance(equations, [&](std::size_t i) { return views[i].tag; });
  const double of_blocks = pull_variance(
      equations, [&](std::size_t i) { return views[i].frame * kBlocksOfFilm / (last_frame + 1); });
  const double variance = std::max({h, of_views, of_tags, of_blocks});
  return std::sqrt(variance + by_print * by_print * kPrintSigma_m * kPrintSigma_m) / h;
}

}  // namespace

std::optional<FittedExponent> fit_exponent(std::vector<ResponseView>& views, double first,
                                           const ParallelFor& parallel) {
  double exponent = first, step = 0.0;
  for (int round = 0; round < kMostResponseRounds; ++round) {
    const CodeCurve curve = CodeCurve::gamma(exponent);
    const auto next = [&](CodedTag& view) -> std::optional<CodedTag::Equation> {
      if (round > 0 && !view.advance(step)) return std::nullopt;
      const auto equation = view.linearise(curve);
      if (equation && round < kRoundsOfNoise) view.measure_noise();
      return equation;
    };
    const Equations equations = step_all(views, next, parallel);
    double h = 0.0, g = 0.0;
    for (const CodedTag::Equation& one : equations) {
      h += one.h;
      g += one.g;
    }
    if (!(h > 0.0)) return std::nullopt;
    if (round > kRoundsOfNoise && std::abs(g / h) < kSettledStep)
      return FittedExponent{exponent, sigma_of(equations, views)};
    step = std::clamp(g / h, -kMostRoundStep, kMostRoundStep);
    exponent += step;
    if (!(exponent > kLowestExponent && exponent < kHighestExponent)) return std::nullopt;
  }
  return std::nullopt;
}

double sigmas_worse(const std::vector<ResponseView>& views, const CodeCurve& other, const CodeCurve& curve,
                    const ParallelFor& parallel) {
  std::vector<std::optional<double>> excess(views.size());
  parallel(views.size(), [&](std::size_t i) {
    CodedTag with_other = views[i].view, with_curve = views[i].view;
    if (!with_other.begin(other)) return;
    const auto cost_other = with_other.settle(other), cost_curve = with_curve.linearise(curve);
    if (cost_other && cost_curve) excess[i] = cost_other->cost - cost_curve->cost;
  });
  std::map<int, double> of_frame, of_view;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (!excess[i]) continue;
    of_frame[views[i].frame] += *excess[i];
    of_view[static_cast<int>(i)] = *excess[i];
  }
  const auto& groups = of_frame.size() < kManyFrames ? of_view : of_frame;
  const auto count = static_cast<double>(groups.size());
  if (groups.size() < kLeastGroups) return 0.0;
  double sum = 0.0, squares = 0.0;
  for (const auto& [group, value] : groups) sum += value;
  for (const auto& [group, value] : groups) squares += (value - sum / count) * (value - sum / count);
  const double error = std::sqrt(squares / (count - 3.0) / count);
  return sum / count / std::max(error, 1e-9);
}

}  // namespace apriltrack
