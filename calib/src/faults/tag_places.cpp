#include "faults/tag_places.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "apriltrack/base/degrees.h"

namespace apriltrack {
namespace {

constexpr std::size_t kLeastOfMoved = 3;      // views at each of the places
constexpr std::size_t kLeastOfCopy = 2;       // of two wrong views, hardly any agree on a place
constexpr double kMostOfPlace = 2.5;          // of the usual cost
constexpr double kElsewhereSquares = 7000.0;  // thirty
// Apart: by so much, so clearly.
constexpr double kClearSquares = 45.0;      // of six numbers: chance in a million
constexpr double kClearMoveInSizes = 0.02;  // of the tag's size; and at least
constexpr double kClearMove_m = 0.003;
constexpr double kClearTurn_rad = 1.0 * kRadPerDeg;
// Of the size: prints with their margins do not overlap; about an edge of two walls their centres may be
// near.
constexpr double kSideBySide = 1.2, kAboutAnEdge = 0.8, kAnEdge_rad = 45.0 * kRadPerDeg;

double cost_at(const std::vector<ProbeView>& probes, const TagFit& fit) {
  double sum = 0.0;
  for (const ProbeView& probe : probes) sum += probe_cost(probe, fit.T_map_tag, fit.shape);
  return sum;
}

std::vector<ProbeView> where(const std::vector<ProbeView>& probes, const std::vector<bool>& flags,
                             bool value) {
  std::vector<ProbeView> chosen;
  for (std::size_t i = 0; i < probes.size(); ++i) {
    if (flags[i] == value) chosen.push_back(probes[i]);
  }
  return chosen;
}

/// The moment at which it costs least to go over from one place to the other; 0 or probes.size(): never.
std::size_t best_change(const std::vector<ProbeView>& probes, const TagFit& first, const TagFit& second) {
  double all_second = cost_at(probes, second), least = all_second;
  std::size_t best = 0;
  for (std::size_t i = 0; i < probes.size(); ++i) {
    all_second += probe_cost(probes[i], first.T_map_tag, first.shape) -
                  probe_cost(probes[i], second.T_map_tag, second.shape);
    if (all_second < least) {
      least = all_second;
      best = i + 1;
    }
  }
  return best;
}

/// Both places fitted to the views that are said to show them, at least so many each.
std::optional<TwoPlaces> fit_two(const std::vector<ProbeView>& probes, std::vector<bool> at_second,
                                 double size_m, std::size_t least) {
  const auto first = where(probes, at_second, false), second = where(probes, at_second, true);
  if (first.size() < least || second.size() < least) return std::nullopt;
  TwoPlaces result{0.0, fit_tag_anew(first, size_m), fit_tag_anew(second, size_m), std::move(at_second)};
  result.cost = result.fit.cost + result.second.cost;
  return result;
}

/// What the place explains badly.
std::vector<bool> are_elsewhere(const std::vector<ProbeView>& probes, const TagFit& one) {
  std::vector<bool> result;
  for (const ProbeView& probe : probes)
    result.push_back(probe_cost(probe, one.T_map_tag, one.shape) > 4.0 * usual_probe_cost() * probe.share);
  return result;
}

/// Two tags of one id need not be of one size.
void allow_another_size(const std::vector<ProbeView>& probes, TagFit& fit) {
  TagFit scaled = fit_tag(probes, fit, ShapeFreedom::kSize);
  scaled.cost += kFeeOfUnknown;
  if (scaled.cost < fit.cost) fit = scaled;
}

/// Whether the places differ by more than their errors, and by `least_m`.
bool are_apart(const TwoPlaces& two, double least_m) {
  const Pose change = two.change();
  const Vector6d xi = change.log();
  const Matrix6d covariance = two.fit.covariance + two.second.covariance;
  const double squares = xi.dot(covariance.ldlt().solve(xi));
  return squares > kClearSquares && change.translation().norm() > least_m;
}

/// Whether one tag there explains the views, in frames that are beyond doubt, and nothing at the other place
/// does.
bool is_plainly_a_place(const TagFit& fit, const TagFit& other, const std::vector<ProbeView>& views) {
  return fit.cost < kMostOfPlace * usual_cost_of(views) &&
         std::ranges::all_of(views, [&](const ProbeView& view) {
           return view.is_frame_sure && probe_squares(view, other.T_map_tag, other.shape) > kElsewhereSquares;
         });
}

bool is_a_place(const TagFit& fit, const TagFit& other, const std::vector<ProbeView>& views) {
  return views.size() >= kLeastOfMoved || is_plainly_a_place(fit, other, views);
}

/// How far apart two tags that hang at a time must be, one turned and shifted so against the other.
double least_between_tags_m(const Pose& change, double size_m) {
  const double turn_rad = rotation_angle_rad(change.rotation(), Eigen::Quaterniond::Identity());
  return size_m * (turn_rad > kAnEdge_rad ? kAboutAnEdge : kSideBySide);
}

/// Where views that are so and others are told apart best by time: the first after the change.
std::size_t moment_of_change(const std::vector<bool>& is_so) {
  const auto num = std::ranges::count(is_so, true);
  const double share = static_cast<double>(num) / static_cast<double>(is_so.size());
  double excess = 0.0, most = 0.0;
  std::size_t best = 0;
  for (std::size_t i = 0; i < is_so.size(); ++i) {
    excess += (is_so[i] ? 1.0 : 0.0) - share;
    if (std::abs(excess) <= most) continue;
    most = std::abs(excess);
    best = i + 1;
  }
  return best;
}

/// So that `fit` is the place of the first view.
void put_first_view_first(TwoPlaces& two) {
  if (!two.is_at_second.front()) return;
  std::swap(two.fit, two.second);
  two.is_at_second.flip();
}

}  // namespace

double least_shift_m(const Pose& change, double size_m) {
  const double turn_rad = rotation_angle_rad(change.rotation(), Eigen::Quaterniond::Identity());
  return turn_rad > kClearTurn_rad ? 0.0 : std::max(kClearMoveInSizes * size_m, kClearMove_m);
}

std::optional<TwoPlaces> moved_once(const std::vector<ProbeView>& probes, const TagFit& one, double size_m) {
  std::optional<TwoPlaces> best;
  const std::size_t num = probes.size();
  for (std::size_t change : {moment_of_change(are_elsewhere(probes, one)), num / 4, num / 2, 3 * num / 4}) {
    std::optional<TwoPlaces> trial;
    for (int round = 0; round < 4; ++round) {
      std::vector<bool> at_second(probes.size());
      for (std::size_t i = 0; i < probes.size(); ++i) at_second[i] = i >= change;
      auto next = fit_two(probes, std::move(at_second), size_m, kLeastOfMoved);
      if (!next) break;
      trial = std::move(next);
      const std::size_t better = best_change(probes, trial->fit, trial->second);
      if (better == change) break;
      change = better;
    }
    if (trial && (!best || trial->cost < best->cost)) best = std::move(trial);
  }
  if (!best) return std::nullopt;
  best->cost += 7.0 * kFeeOfUnknown;
  return are_apart(*best, least_shift_m(best->change(), size_m)) ? best : std::nullopt;
}

bool is_one_change(const std::vector<bool>& is_at_second) {
  std::size_t changes = 0;
  for (std::size_t i = 1; i < is_at_second.size(); ++i) changes += is_at_second[i] != is_at_second[i - 1];
  return changes == 1;
}

// The views that the one place explains worst tell where the other is.
std::optional<TwoPlaces> two_places(const std::vector<ProbeView>& probes, const TagFit& one, double size_m) {
  std::vector<bool> at_second = are_elsewhere(probes, one);
  std::optional<TwoPlaces> result;
  for (int round = 0; round < 4; ++round) {
    auto next = fit_two(probes, at_second, size_m, kLeastOfCopy);
    if (!next) break;
    result = std::move(next);
    for (std::size_t i = 0; i < probes.size(); ++i)
      at_second[i] = probe_cost(probes[i], result->second.T_map_tag, result->second.shape) <
                     probe_cost(probes[i], result->fit.T_map_tag, result->fit.shape);
    if (at_second == result->is_at_second) break;
  }
  if (!result || !are_apart(*result, least_between_tags_m(result->change(), size_m))) return std::nullopt;
  const auto at_first = where(probes, result->is_at_second, false),
             elsewhere = where(probes, result->is_at_second, true);
  allow_another_size(at_first, result->fit);
  allow_another_size(elsewhere, result->second);
  if (!is_a_place(result->fit, result->second, at_first) ||
      !is_a_place(result->second, result->fit, elsewhere))
    return std::nullopt;
  result->cost = result->fit.cost + result->second.cost;
  const auto minority = static_cast<double>(std::min(at_first.size(), elsewhere.size()));
  result->cost += 6.0 * kFeeOfUnknown + minority;
  put_first_view_first(*result);
  return result;
}

PlaceChange change_at_a_moment(const TwoPlaces& two, const std::vector<Timestamp>& times) {
  const auto second =
      static_cast<std::size_t>(std::ranges::find(two.is_at_second, true) - two.is_at_second.begin());
  return {.T_first_second = two.change(),
          .is_one_after_other = true,
          .last_at_first = times[second == 0 ? 0 : second - 1],
          .first_at_second = times[second]};
}

PlaceChange change_by_turns(const TwoPlaces& two) {
  return {.T_first_second = two.change(),
          .is_one_after_other = false,
          .last_at_first = {},
          .first_at_second = {}};
}

}  // namespace apriltrack
