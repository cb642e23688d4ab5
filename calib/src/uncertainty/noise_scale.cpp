#include "uncertainty/noise_scale.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "model/corner_views.h"
#include "numerics/upper_median.h"
#include "uncertainty/error_scale.h"

namespace apriltrack {
namespace {

constexpr double kSigmaPerMedian = 1.4826;  // of a normal distribution
constexpr double kExpectedResiduals =
    15.0;  // the expected sigma counts as many; two frames of two tags leave 14
constexpr double kLeastRedundancy = 0.15;  // below, the frame's pose hides the error
constexpr double kClearSpread = 0.05;      // of frames' variances about their mean, beyond chance

/// What is left of each of a view's eight numbers when its frame's pose has followed it.
struct Redundancy {
  LinearView::Residual residual;
  LinearView::Residual share;  ///< In [0, 1].
  int frame = 0;

  double squares() const { return residual.squaredNorm(); }
  double count() const { return share.sum(); }
};

std::vector<Redundancy> redundancies(const std::vector<LinearView>& views) {
  std::map<int, Matrix6d> information;
  for (const LinearView& view : views)
    information.try_emplace(view.frame, Matrix6d::Zero()).first->second +=
        view.by_rig.transpose() * view.by_rig;
  std::map<int, Eigen::LDLT<Matrix6d>> factors;
  for (const auto& [frame, H] : information) factors[frame].compute(H);
  std::vector<Redundancy> result;
  for (const LinearView& view : views) {
    const LinearView::ByPose by_rig = view.by_rig;
    const Eigen::MatrixXd followed = factors.at(view.frame).solve(by_rig.transpose());
    const LinearView::Residual leverage = by_rig.cwiseProduct(followed.transpose()).rowwise().sum();
    result.push_back({view.residual, (1.0 - leverage.array()).cwiseMax(0.0).cwiseMin(1.0), view.frame});
  }
  return result;
}

/// The share of the residuals beyond frames' poses that the tags' poses leave.
double share_left_by_tags(const std::vector<LinearView>& views, double beyond_frames) {
  std::set<int> tags;
  for (const LinearView& view : views) tags.insert(view.tag);
  const double of_tags = 6.0 * (static_cast<double>(tags.size()) - 1.0);
  return beyond_frames > 0.0 ? std::max(0.0, 1.0 - of_tags / beyond_frames) : 0.0;
}

bool is_claimed(const TagView& view) {
  return view.claimed_px2 > 0.0;
}

/// Those that corner_views() gives.
std::vector<std::size_t> projected(const Observations& observations, std::vector<std::size_t> views,
                                   const MapState& state) {
  std::erase_if(views, [&](std::size_t v) {
    Vector8d residual_px;
    return !residual_of(observations, observations.views[v], state, &residual_px);
  });
  return views;
}

/// Squares of a view in units of what its claim lets expect, and of how many numbers.
struct ClaimedView {
  double squares = 0.0, count = 0.0;
};

/// Logarithm of the views' likelihood by Student's distribution of the likeliest scale.
double log_likelihood(const std::vector<ClaimedView>& views) {
  constexpr int kSteps = 20;
  const auto weight = [](const ClaimedView& view, double variance) {
    return (kTailFreedom + view.count) / (kTailFreedom + view.squares / variance);
  };
  double variance = 1.0;
  for (int step = 0; step < kSteps; ++step) {
    double squares = 0.0, count = 0.0;
    for (const ClaimedView& view : views) {
      squares += weight(view, variance) * view.squares;
      count += view.count;
    }
    if (!(squares > 0.0)) return 0.0;
    variance = squares / count;
  }
  double sum = 0.0;
  for (const ClaimedView& view : views)
    sum -= 0.5 * view.count * std::log(variance) +
           0.5 * (kTailFreedom + view.count) * std::log1p(view.squares / (kTailFreedom * variance));
  return sum;
}

/// What corners err by beyond their claims, px: the likeliest, of steps by a factor of sqrt(2) each. Views
/// whose claims are all alike do not tell; then it is as expected.
double likeliest_beyond_px(const Observations& observations, const std::vector<std::size_t>& views,
                           MapState state) {
  constexpr double kSigmaOfLog = 1.5;  // what is expected, .02 px, is known to a factor of four or five
  constexpr int kLeast = -10, kMost = 4;
  state.noise = {};
  std::vector<std::size_t> claimed = views;
  std::erase_if(claimed, [&](std::size_t v) { return !is_claimed(observations.views[v]); });
  if (claimed.empty()) return kBeyondClaim_px;
  claimed = projected(observations, std::move(claimed), state);
  const std::vector<Redundancy> all = redundancies(corner_views(observations, claimed, state));
  double best_px = kBeyondClaim_px, most = -HUGE_VAL;
  for (int step = kLeast; step <= kMost; ++step) {
    const double beyond_px = kBeyondClaim_px * std::pow(2.0, 0.5 * step);
    std::vector<ClaimedView> scaled;
    double log_scales = 0.0;
    for (std::size_t i = 0; i < claimed.size(); ++i) {
      const double scale = scale_by_claim(observations.views[claimed[i]], beyond_px);
      scaled.push_back({all[i].squares() / (scale * scale), all[i].count()});
      log_scales += all[i].count() * std::log(scale);
    }
    const double off = std::log(beyond_px / kBeyondClaim_px) / kSigmaOfLog;
    const double likelihood = log_likelihood(scaled) - log_scales - 0.5 * off * off;
    if (likelihood <= most) continue;
    most = likelihood;
    best_px = beyond_px;
  }
  return best_px;
}

}  // namespace

NoiseScale measure_noise(const Observations& observations, const std::vector<std::size_t>& views,
                         const MapState& state) {
  MapState even = state;
  even.noise = state.noise.of_all();
  even.noise.beyond_px = likeliest_beyond_px(observations, views, state);
  const std::vector<LinearView> linear = corner_views(observations, views, even);
  std::array<std::vector<double>, 2> magnitudes;  // of sums, of differences
  std::array<double, 2> counts{};
  for (const Redundancy& view : redundancies(linear)) {
    for (Eigen::Index i = 0; i < view.residual.size(); ++i) {
      const auto kind = static_cast<std::size_t>(i % 2);
      counts[kind] += view.share[i];
      if (view.share[i] > kLeastRedundancy)
        magnitudes[kind].push_back(std::abs(view.residual[i]) / std::sqrt(view.share[i]));
    }
  }
  const double left = share_left_by_tags(linear, counts[0] + counts[1]);
  const auto scale = [&](std::size_t kind, double before) {
    const double median = magnitudes[kind].empty() ? 0.0 : upper_median(magnitudes[kind]);
    const double measured = before * kSigmaPerMedian * median;
    const double count = left * counts[kind];
    // What the tags take away makes the numbers smaller, too.
    const double squares = count * measured * measured / std::max(left, 0.1);
    return std::max(kMinScale,
                    std::sqrt((0.5 * kExpectedResiduals + squares) / (0.5 * kExpectedResiduals + count)));
  };
  return {scale(0, state.noise.sum), scale(1, state.noise.difference), even.noise.beyond_px};
}

std::vector<double> measure_view_noise(const Observations& observations,
                                       const std::vector<std::size_t>& views, const MapState& state) {
  std::vector<double> scales;
  if (std::ranges::none_of(views, [&](std::size_t v) { return is_claimed(observations.views[v]); }))
    return scales;
  MapState even = state;
  even.noise = state.noise.of_all();
  const std::vector<std::size_t> seen = projected(observations, views, even);
  const std::vector<Redundancy> all = redundancies(corner_views(observations, seen, even));
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const TagView& view = observations.views[seen[i]];
    if (!is_claimed(view)) continue;
    if (scales.size() <= view.index) scales.resize(view.index + 1, 1.0);
    scales[view.index] = std::sqrt((kTailFreedom + all[i].squares()) / (kTailFreedom + all[i].count()));
  }
  return scales;
}

std::vector<double> measure_frame_noise(const Observations& observations,
                                        const std::vector<std::size_t>& views, const MapState& state) {
  MapState even = state;
  even.noise.of_frame.clear();
  struct Sums {
    double squares = 0.0, count = 0.0;
  };
  std::map<int, Sums> frames;
  Sums all;
  for (const Redundancy& view : redundancies(corner_views(observations, views, even))) {
    Sums& frame = frames[view.frame];
    frame.squares += view.residual.squaredNorm();
    frame.count += view.share.sum();
  }
  for (const auto& [index, frame] : frames) {
    all.squares += frame.squares;
    all.count += frame.count;
  }
  std::vector<double> scales(observations.frames.size(), 1.0);
  if (!(all.squares > 0.0)) return scales;
  const double mean = all.squares / all.count;
  // Method of moments: how frames' variances spread about their mean, beyond what so few residuals do.
  double spread = 0.0, weights = 0.0;
  for (const auto& [index, frame] : frames) {
    if (frame.count < 2.0) continue;
    const double excess = frame.squares / (frame.count * mean) - 1.0;
    spread += frame.count * (excess * excess - 2.0 / frame.count);
    weights += frame.count;
  }
  if (!(spread > kClearSpread * weights)) return scales;
  const double prior =
      2.0 * weights / spread + 4.0;  // degrees of freedom of an inverse chi-squared of that spread
  for (const auto& [index, frame] : frames)
    scales[static_cast<std::size_t>(index)] =
        std::sqrt((prior + frame.squares / mean) / (prior + frame.count));
  return scales;
}

}  // namespace apriltrack
