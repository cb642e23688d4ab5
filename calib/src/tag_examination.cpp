#include "tag_examination.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <set>
#include <utility>

#include "apriltrack/base/error.h"
#include "undecided_tags.h"

namespace apriltrack {
namespace {

constexpr std::size_t kLeastProbes = 4;
constexpr std::size_t kMostProbes = 160;
constexpr std::size_t kLeastOfPlace = 3;  // views
// Clear: by so many standard deviations, so much of the tag's size, and so much of half the sum of squares.
constexpr double kClearSigmas = 5.0;
constexpr double kClearSquares = 45.0;  // of six numbers: chance in a million
constexpr double kClearScale = 0.012;
constexpr double kClearBend = 0.006;
constexpr double kClearMove = 0.02;  // of the tag's size; and at least
constexpr double kClearMove_m = 0.003;
constexpr double kClearTurn_rad = 1.0 * std::numbers::pi / 180.0;
constexpr double kClearGain = 20.0;
constexpr double kClearShare = 0.25;    // of what is beyond the usual
constexpr double kPerNumber = 2.0;      // what a further unknown must gain to be preferred
constexpr double kMisfitOfLoose = 2.0;  // something is always left
constexpr double kOneObject_m = 1.0;    // farther, and it may as well be two tags

using Kind = TagFinding::Kind;

struct Hypothesis {
  Kind kind;
  double cost;  ///< With a fee for its unknowns.
  TagFit fit, second;
  std::vector<bool> is_at_second;  ///< By view, of two places.
};

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

/// Both places fitted to the views that are said to show them.
std::optional<Hypothesis> fit_two(const std::vector<ProbeView>& probes, Kind kind,
                                  std::vector<bool> at_second, double size_m) {
  const auto first = where(probes, at_second, false), second = where(probes, at_second, true);
  if (first.size() < kLeastOfPlace || second.size() < kLeastOfPlace) return std::nullopt;
  Hypothesis result{kind, 0.0, fit_tag_anew(first, size_m), fit_tag_anew(second, size_m),
                    std::move(at_second)};
  result.cost = result.fit.cost + result.second.cost;
  return result;
}

std::optional<Hypothesis> moved_once(const std::vector<ProbeView>& probes, double size_m) {
  std::optional<Hypothesis> best;
  for (const double share : {0.25, 0.5, 0.75}) {
    auto change = static_cast<std::size_t>(share * static_cast<double>(probes.size()));
    std::optional<Hypothesis> trial;
    for (int round = 0; round < 4; ++round) {
      std::vector<bool> at_second(probes.size());
      for (std::size_t i = 0; i < probes.size(); ++i) at_second[i] = i >= change;
      auto next = fit_two(probes, Kind::kMoved, std::move(at_second), size_m);
      if (!next) break;
      trial = std::move(next);
      const std::size_t better = best_change(probes, trial->fit, trial->second);
      if (better == change) break;
      change = better;
    }
    if (trial && (!best || trial->cost < best->cost)) best = std::move(trial);
  }
  if (best) best->cost += 7.0 * kPerNumber;
  return best;
}

/// By turns: the views that the one place explains worst tell where the other is.
std::optional<Hypothesis> two_places(const std::vector<ProbeView>& probes, const TagFit& one, double size_m) {
  std::vector<bool> at_second(probes.size());
  for (std::size_t i = 0; i < probes.size(); ++i)
    at_second[i] = probe_cost(probes[i], one.T_map_tag, one.shape) > 4.0 * usual_probe_cost();
  std::optional<Hypothesis> result;
  for (int round = 0; round < 4; ++round) {
    auto next = fit_two(probes, Kind::kTwoPlaces, at_second, size_m);
    if (!next) return result;
    result = std::move(next);
    for (std::size_t i = 0; i < probes.size(); ++i)
      at_second[i] = probe_cost(probes[i], result->second.T_map_tag, result->second.shape) <
                     probe_cost(probes[i], result->fit.T_map_tag, result->fit.shape);
    if (at_second == result->is_at_second) break;
  }
  const auto minority = static_cast<double>(std::min(std::ranges::count(result->is_at_second, true),
                                                     std::ranges::count(result->is_at_second, false)));
  result->cost += 6.0 * kPerNumber + minority;
  return result;
}

bool is_clear(double value, double sigma, double least, double misfit) {
  return std::abs(value) > std::max(least, kClearSigmas * sigma * std::sqrt(std::max(1.0, misfit)));
}

/// Whether the places differ by more than their errors.
bool are_apart(const Hypothesis& two, double size_m) {
  const Pose change = two.fit.T_map_tag.inverse() * two.second.T_map_tag;
  const Vector6d xi = change.log();
  const Matrix6d covariance = two.fit.covariance + two.second.covariance;
  const double squares = xi.dot(covariance.ldlt().solve(xi));
  const bool is_far = change.translation().norm() > std::max(kClearMove * size_m, kClearMove_m) ||
                      xi.tail<3>().norm() > kClearTurn_rad;
  return is_far && squares > kClearSquares;
}

/// Of the views: many that no one place explains, though each by itself is a tag's.
bool is_loose(const std::vector<ProbeView>& probes, const TagFit& one) {
  constexpr double kFarOff = 30.0, kAsUsual = 12.0;  // squares; 8 and 2 are expected
  std::size_t far = 0, explained = 0;
  for (const ProbeView& probe : probes) {
    const double cost = probe_cost(probe, one.T_map_tag, one.shape);
    if (cost < usual_probe_cost() * kFarOff / 8.0 * 0.8) continue;
    ++far;
    const TagFit alone = fit_tag_anew({probe}, one.shape.size_m);
    if (alone.cost < usual_probe_cost() * kAsUsual / 8.0) ++explained;
  }
  return static_cast<double>(far) > 0.35 * static_cast<double>(probes.size()) &&
         static_cast<double>(explained) > 0.8 * static_cast<double>(far);
}

double seconds_in(const Observations& observations, Timestamp time) {
  return seconds_between(observations.frames.front(), time);
}

std::string describe_size(const Hypothesis& one, const std::string& name) {
  const double scale = std::exp(one.fit.shape.log_scale);
  return fmt::format(
      "{} looks {:.1f} % {} than its stated size of {:.4g} m (sigma {:.1f} %): a wrong size was given, or it "
      "was "
      "printed at another scale; measure it (about {:.4g} m), and correct --tag-size or --tag-sizes. It is "
      "left "
      "out",
      name, 100.0 * std::abs(scale - 1.0), scale > 1.0 ? "larger" : "smaller", one.fit.shape.size_m,
      100.0 * one.fit.scale_sigma, scale * one.fit.shape.size_m);
}

std::string describe_bend(const Hypothesis& one, const std::string& name) {
  const TagShape& shape = one.fit.shape;
  std::string what;
  if (is_clear(shape.twist, one.fit.twist_sigma, kClearBend, 1.0))
    what = fmt::format("its corners lie {:.1f} mm (sigma {:.1f}) before and behind one plane",
                       1e3 * std::abs(shape.twist) * shape.size_m, 1e3 * one.fit.twist_sigma * shape.size_m);
  if (is_clear(shape.aspect, one.fit.aspect_sigma, kClearBend, 1.0))
    what += fmt::format("{}it is {:.1f} % (sigma {:.1f}) {} than high", what.empty() ? "" : ", and ",
                        100.0 * std::abs(shape.aspect), 100.0 * one.fit.aspect_sigma,
                        shape.aspect > 0.0 ? "wider" : "narrower");
  return fmt::format(
      "{} is bent, not flat, or was printed unevenly: {}. Fix it to a flat, stiff board; its pose is that of "
      "the "
      "plane through its corners",
      name, what);
}

std::string describe_places(const Hypothesis& two, const std::vector<ProbeView>& probes,
                            const Observations& observations, const std::string& name) {
  const Pose change = two.fit.T_map_tag.inverse() * two.second.T_map_tag;
  const double distance_m = change.translation().norm();
  const std::string how_far = fmt::format(
      "{:.3g} m and {:.1f} degrees", distance_m,
      rotation_angle_rad(change.rotation(), Eigen::Quaterniond::Identity()) * 180.0 / std::numbers::pi);
  const bool is_by_turns = two.kind == Kind::kTwoPlaces;
  if (is_by_turns || distance_m > kOneObject_m)
    return fmt::format(
        "{} is seen at two places, {}, {} apart: its id hangs twice (a duplicate), or it was carried from "
        "one to "
        "the other. It is left out: cover one, or give it another id",
        name, is_by_turns ? "by turns" : "one after the other", how_far);
  const auto second = std::ranges::find(two.is_at_second, true) - two.is_at_second.begin();
  const ProbeView& before = probes[static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, second - 1))];
  const ProbeView& after = probes[static_cast<std::size_t>(second)];
  return fmt::format(
      "{} was moved by {} while filming, between {:.2f} and {:.2f} s after the first frame. It is left out: "
      "film "
      "again, with all tags fixed",
      name, how_far, seconds_in(observations, before.timestamp), seconds_in(observations, after.timestamp));
}

std::string describe_loose(const std::string& name) {
  return fmt::format(
      "{} hangs loosely: it moves from view to view, and no fixed place explains them. It is left out: fix "
      "it to "
      "the wall",
      name);
}

std::vector<Hypothesis> hypotheses_about(const std::vector<ProbeView>& probes, const TagFit& one,
                                         double misfit) {
  const double size_m = one.shape.size_m;
  std::vector<Hypothesis> result;
  const TagFit scaled = fit_tag(probes, one, ShapeFreedom::kSize);
  if (is_clear(scaled.shape.log_scale, scaled.scale_sigma, kClearScale, misfit))
    result.push_back({Kind::kSize, scaled.cost, scaled, {}, {}});
  const TagFit bent = fit_tag(probes, one, ShapeFreedom::kBend);
  if (is_clear(bent.shape.aspect, bent.aspect_sigma, kClearBend, misfit) ||
      is_clear(bent.shape.twist, bent.twist_sigma, kClearBend, misfit))
    result.push_back({Kind::kNotFlat, bent.cost + 2.0 * kPerNumber, bent, {}, {}});
  if (misfit < 1.2) return result;
  auto moved = moved_once(probes, size_m);
  if (moved && are_apart(*moved, size_m)) result.push_back(std::move(*moved));
  auto places = two_places(probes, one, size_m);
  if (places && are_apart(*places, size_m)) result.push_back(std::move(*places));
  return result;
}

std::vector<ProbeView> some_of(std::vector<ProbeView> probes) {
  if (probes.size() <= kMostProbes) return probes;
  std::vector<ProbeView> chosen;
  for (std::size_t i = 0; i < kMostProbes; ++i) chosen.push_back(probes[i * probes.size() / kMostProbes]);
  return chosen;
}

}  // namespace

double misfit_of(const std::vector<ProbeView>& all_probes, const Observations& observations, int tag) {
  const std::vector<ProbeView> probes = some_of(all_probes);
  if (probes.size() < kLeastProbes) return 0.0;
  const TagFit one = fit_tag_anew(probes, observations.sizes_m[static_cast<std::size_t>(tag)]);
  return one.cost / (usual_probe_cost() * static_cast<double>(probes.size()));
}

std::optional<TagFinding> diagnose(const std::vector<ProbeView>& all_probes, const Observations& observations,
                                   int tag) {
  const std::vector<ProbeView> probes = some_of(all_probes);
  if (probes.size() < kLeastProbes) return std::nullopt;
  const auto t = static_cast<std::size_t>(tag);
  const std::string name = to_string(observations.tags[t]);
  const TagFit one = fit_tag_anew(probes, observations.sizes_m[t]);
  const double usual = usual_probe_cost() * static_cast<double>(probes.size());
  const double misfit = one.cost / usual;
  std::vector<Hypothesis> hypotheses = hypotheses_about(probes, one, misfit);
  const auto best = std::ranges::min_element(hypotheses, {}, &Hypothesis::cost);
  const double excess = std::max(0.0, one.cost - usual);
  const bool is_explained = best != hypotheses.end() && one.cost - best->cost > kClearGain &&
                            one.cost - best->cost > kClearShare * excess;
  if (is_explained && best->cost < 2.5 * usual) {
    TagFinding finding{tag, best->kind, {}, best->kind != Kind::kNotFlat, misfit, best->cost / usual};
    if (best->kind == Kind::kSize) {
      finding.words = describe_size(*best, name);
    } else if (best->kind == Kind::kNotFlat) {
      finding.words = describe_bend(*best, name);
    } else {
      finding.words = describe_places(*best, probes, observations, name);
    }
    return finding;
  }
  if (misfit > 2.0 && is_loose(probes, one))
    return TagFinding{tag, Kind::kLoose, describe_loose(name), true, misfit, kMisfitOfLoose};
  return std::nullopt;
}

namespace {

constexpr int kMostFaults = 4;
constexpr std::size_t kMostSuspects = 6;
constexpr double kSuspicious = 2.5;

/// Tags that are not `known` to be at fault: those with a fault that can be named, and those whose views no
/// fault explains as the map is, worst first.
std::vector<int> suspects_in(const PartTask& task, const Part& part, const AdjustedPart& solved,
                             const std::set<int>& known) {
  std::vector<std::pair<double, int>> suspects;
  for (const int tag : part.tags) {
    if (known.contains(tag) || std::ranges::binary_search(solved.undecided, tag)) continue;
    const std::vector<ProbeView> probes = probe_views(task, part, solved, tag);
    const double misfit = misfit_of(probes, task.observations, tag);
    if (misfit > kSuspicious || diagnose(probes, task.observations, tag)) suspects.emplace_back(-misfit, tag);
  }
  std::ranges::sort(suspects);
  std::vector<int> tags;
  for (const auto& [misfit, tag] : suspects) tags.push_back(tag);
  return tags;
}

struct Absence {
  TagFinding finding;  ///< Of the tag that was left out.
  AdjustedPart rest;
  std::size_t num_others = 0;  ///< That still seem at fault.
};

/// The map without a tag, and what the tag looks like from there. Null where nothing is wrong with it then,
/// or too little is left.
std::unique_ptr<Absence> look_without(const PartTask& task, const Part& part, const AdjustedPart& solved,
                                      int tag, const std::set<int>& known) {
  std::vector<std::size_t> views = part.views;
  std::erase_if(views, [&](std::size_t v) {
    const int of_view = task.observations.views[v].tag;
    return of_view == tag || std::ranges::binary_search(solved.undecided, of_view) ||
           (known.contains(of_view) && !std::ranges::binary_search(solved.part.tags, of_view));
  });
  auto trial = std::make_unique<Absence>();
  trial->rest = solved;
  if (!hold_another(task, {tag}, trial->rest)) return nullptr;
  const Part rest = connected_to(task.observations, views, trial->rest.held_tag, task.options.min_views);
  if (rest.tags.size() < 2) return nullptr;
  try {
    // From the start: with the tag, the map may have been folded.
    const AdjustedPart anew = adjust_part(task, rest, trial->rest.held_tag, parallel_for(1));
    trial->rest.part = anew.part;
    trial->rest.state = anew.state;
  } catch (const Error&) {  // too little is left that agrees
    return nullptr;
  }
  auto finding = diagnose(probe_views(task, part, trial->rest, tag), task.observations, tag);
  if (!finding) return nullptr;
  trial->finding = std::move(*finding);
  std::set<int> all_known = known;
  all_known.insert(tag);
  trial->num_others = suspects_in(task, part, trial->rest, all_known).size();
  return trial;
}

}  // namespace

std::vector<TagFinding> examine_tags(const PartTask& task, const Part& part, AdjustedPart& solved) {
  std::vector<TagFinding> findings;
  if (part.tags.size() < 3) return findings;  // of two that disagree, either may be wrong
  std::set<int> known;
  if (solved.culprit) {
    known.insert(*solved.culprit);
    auto finding =
        diagnose(probe_views(task, part, solved, *solved.culprit), task.observations, *solved.culprit);
    if (finding) {
      if (!finding->is_left_out) finding->words += ". It is left out";
      finding->is_left_out = true;
      findings.push_back(std::move(*finding));
    }
  }
  for (int round = 0; round < kMostFaults; ++round) {
    std::vector<int> suspects = suspects_in(task, part, solved, known);
    suspects.resize(std::min(suspects.size(), kMostSuspects));
    std::unique_ptr<Absence> best;  // whose absence leaves the fewest that seem wrong, and explains most
    for (const int suspect : suspects) {
      auto trial = look_without(task, part, solved, suspect, known);
      if (!trial) continue;
      const auto rank = [](const Absence& one) { return std::pair(one.num_others, -one.finding.gain()); };
      if (!best || rank(*trial) < rank(*best)) best = std::move(trial);
    }
    if (!best) break;
    known.insert(best->finding.tag);
    if (best->finding.is_left_out) solved = std::move(best->rest);
    findings.push_back(std::move(best->finding));
  }
  return findings;
}

}  // namespace apriltrack
