#include "hypotheses/faulty_tags.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "faults/part_without.h"
#include "hypotheses/examined_map.h"
#include "hypotheses/fault_finding.h"
#include "hypotheses/part_failure.h"
#include "hypotheses/rivals.h"
#include "model/tag_links.h"
#include "numerics/cauchy_loss.h"
#include "numerics/upper_median.h"

namespace apriltrack {
namespace {

// Posterior odds, nats: 150 to 1, "very strong" by Kass and Raftery (1995). Of 174 tags of six recordings
// the highest had 2.4, the next -0.2.
constexpr double kLikely = 5.0;
constexpr double kWorthAsking = 0.0;  // the same, by errors to which a faulty tag adds
// The camera file's parameters are off by so many of their sigmas, one standard deviation, in so many files.
constexpr double kSigmasOfFile = 3.0, kShareOfFiles = 0.05;
// Scores are to first order. Of 45 planted faults none had a neighbour at more than 0.65 of its own, but one
// that had one before it: what comes so near is asked by a solution without it.
constexpr double kNear = 0.5;
// By solutions, a tag is told from another by kLikely, and by so many standard deviations of what views
// cost that are left out with them. It is that of Cauchy's cost of eight squared normal numbers.
constexpr double kClearlyMore = 2.0, kSpreadOfCost = 1.6;
// Of tags by their scores; and where the map may be folded, of those that most of their frames accuse, and of
// those that fold its links.
constexpr std::size_t kMostScored = 3, kMostAccused = 3, kMostFolding = 5;
constexpr double kMostContradictingLeft = 0.5;  // by the absence of a tag that folds the map
constexpr double kUnseenSquares = 1e4;          // of a view that cannot be projected
constexpr std::size_t kMostTagsToldApart = 40;
constexpr std::size_t kMostTold = 6;  // tags, and pairs of them

/// That the camera file is off.
double log_odds_of(const CameraParameters& cameras, const PartTask& task, const ExaminedMap& map) {
  if (cameras.empty()) return -std::numeric_limits<double>::infinity();
  std::vector<ParameterView> columns =
      camera_columns(task.observations, map.robust.index, map.robust.state, cameras);
  for (std::size_t i = 0; i < columns.size(); ++i) columns[i].by_parameter *= map.robust.root_weights[i];
  const Score score(map.robust.poses->eliminate_poses(columns));
  return evidence_of(score, map.scale, Eigen::VectorXd::Constant(score.gradient.size(), kSigmasOfFile),
                     std::log(kShareOfFiles))
      .log_odds;
}

/// A tag that may be why the map is as it is.
struct Suspect {
  int tag = 0;
  const TagHypothesis* fault = nullptr;            ///< None of a tag that only folds the map.
  std::unique_ptr<ExaminedMap> without = nullptr;  ///< Null where too little is left.
  FaultFound found = {};
  double gain = 0.0;             ///< By which the views' cost falls, were the tag's own explained; nats.
  double views_explained = 0.0;  ///< Its own, and others that the rest does not tie any more.

  double log_odds = -std::numeric_limits<double>::infinity();  ///< Of its fault.

  bool is_likely() const { return log_odds > kLikely; }
  bool leaves_no_fault() const { return without->worst_log_odds() < kLikely; }
  /// Whether nothing is wrong with another tag where this one is not in the map.
  bool clears(int other) const {
    return std::ranges::none_of(without->faults, [&](const TagHypothesis& left) {
      return left.tag == other && left.log_odds() > kLikely;
    });
  }
};

/// cleared: tags that are none.
std::vector<Suspect> suspects_in(const PartTask& task, const ExaminedMap& map, const std::set<int>& cleared,
                                 const ParallelFor& parallel) {
  std::vector<Suspect> suspects;
  const auto suspect = [&](int tag, const TagHypothesis* fault) {
    if (!cleared.contains(tag) && std::ranges::find(suspects, tag, &Suspect::tag) == suspects.end())
      suspects.push_back({.tag = tag, .fault = fault});
  };
  const bool may_be_folded = map.num_contradicting() > 0;
  for (const TagHypothesis& fault : map.faults) {
    if (fault.log_odds() < kWorthAsking || suspects.size() == kMostScored) break;
    if (fault.log_odds() > kNear * map.worst_log_odds() || may_be_folded) suspect(fault.tag, &fault);
  }
  if (!may_be_folded) return suspects;
  const std::vector<int>& accused = map.contradictions.doubtful_tags;
  for (std::size_t i = 0; i < std::min(accused.size(), kMostAccused); ++i) suspect(accused[i], nullptr);
  const auto freed =
      support_freed_by_tags(task.observations.tags.size(),
                            find_links(task.observations, map.robust.part, task.candidates, parallel));
  for (std::size_t i = 0; i < std::min(freed.size(), kMostFolding); ++i) suspect(freed[i].second, nullptr);
  return suspects;
}

double cost_of(const Observations& observations, std::size_t view, const MapState& state) {
  bool is_valid = false;
  const double squares =
      whitened_residual(observations, observations.views[view], state, is_valid).squaredNorm();
  return CauchyLoss{kRobustLoss}.cost(is_valid ? squares : kUnseenSquares);
}

/// Of all views of `with`, by one noise. Those that are not among the others' any more agree with themselves,
/// and then cost what half of the others cost at most.
void measure_gain(const Observations& observations, const RobustMap& with, const NoiseScale& noise,
                  Suspect& suspect) {
  const RobustMap& without = suspect.without->robust;
  MapState before = with.state, after = without.state;
  before.noise = after.noise = noise;
  std::vector<double> costs_of_rest;
  suspect.gain = -suspect.found.left;
  for (const std::size_t v : with.part.views) {
    suspect.gain += cost_of(observations, v, before);
    if (!std::ranges::binary_search(without.part.views, v)) continue;
    costs_of_rest.push_back(cost_of(observations, v, after));
    suspect.gain -= costs_of_rest.back();
  }
  const std::size_t num_left_out = with.part.views.size() - costs_of_rest.size();
  suspect.views_explained = static_cast<double>(num_left_out);
  if (!costs_of_rest.empty()) suspect.gain -= suspect.views_explained * upper_median(costs_of_rest);
}

/// By the errors that the others have without it.
double log_odds_of(const Suspect& suspect, const PartTask& task, const ExaminedMap& map) {
  if (suspect.fault == nullptr) return -std::numeric_limits<double>::infinity();
  return likeliest_fault(task, map.robust, suspect.without->scale, suspect.tag)->log_odds();
}

/// Solves without each; those stay that leave a map, the one first that explains most.
void solve_without_each(const PartTask& task, const Part& part, const ExaminedMap& map,
                        const std::set<int>& bent, std::vector<Suspect>& suspects,
                        const ParallelFor& parallel) {
  const ParallelFor within = suspects.size() > 1 ? on_one_thread(task) : parallel;
  parallel(suspects.size(), [&](std::size_t i) {
    Suspect& one = suspects[i];
    std::set<int> without = bent;
    without.insert(one.tag);
    std::set<int> gone = without;
    gone.merge(tags_left_out(map.solved));
    AdjustedPart rest = map.solved;
    if (!solve_without(task, part, gone, rest, within)) return;
    one.without = examine(task, part, std::move(rest), without, within);
    if (!one.without) return;
    one.log_odds = log_odds_of(one, task, map);
    one.found = fault_of(task, part, one.without->solved, one.tag, &map.robust, one.fault);
    if (one.fault) one.found.finding.log_odds = one.log_odds;
  });
  std::erase_if(suspects, [](const Suspect& one) { return !one.without; });
  const auto size_of = [](const NoiseScale& noise) { return std::hypot(noise.sum, noise.difference); };
  NoiseScale least = map.robust.state.noise;
  for (const Suspect& one : suspects)
    if (size_of(one.without->robust.state.noise) < size_of(least)) least = one.without->robust.state.noise;
  for (Suspect& one : suspects) measure_gain(task.observations, map.robust, least, one);
  const auto merit = [](const Suspect& one) {
    return std::tuple(one.without->num_contradicting(), !one.leaves_no_fault(), -one.gain);
  };
  std::ranges::stable_sort(suspects, {}, merit);
}

bool has_two_places(const TagFinding& finding) {
  return finding.kind == TagFinding::Kind::kMoved || finding.kind == TagFinding::Kind::kTwoPlaces;
}

/// Whether it is why. A tag that only folds the map must end that; where few frames speak of it, by two
/// places.
bool is_why(const Suspect& suspect, const ExaminedMap& map) {
  if (!suspect.found.is_confirmed) return false;
  if (suspect.is_likely()) return true;
  if (!map.contradictions.are_there() && !has_two_places(suspect.found.finding)) return false;
  return suspect.gain > kLikely && static_cast<double>(suspect.without->num_contradicting()) <
                                       kMostContradictingLeft * static_cast<double>(map.num_contradicting());
}

/// The first, and those that explain as much and are cleared by its absence: any of them may be why.
std::vector<Suspect> accused_of(std::vector<Suspect> suspects) {
  const auto leaves_as_much = [](const Suspect& one, const Suspect& best) {
    const double clearly =
        kLikely + kClearlyMore * kSpreadOfCost * std::sqrt(one.views_explained + best.views_explained);
    return one.without->num_contradicting() <= best.without->num_contradicting() &&
           (one.leaves_no_fault() || !best.leaves_no_fault()) && best.clears(one.tag) &&
           best.gain - one.gain < clearly;
  };
  std::vector<Suspect> accused;
  for (Suspect& one : suspects)
    if (accused.empty() || leaves_as_much(one, accused.front())) accused.push_back(std::move(one));
  return accused;
}

/// Of several that may be at fault the one that the user holds is trusted, and the doubt is told.
std::vector<TagFinding> findings_of(const PartTask& task, const std::vector<Suspect>& accused) {
  const auto held =
      std::ranges::find_if(accused, [&](const Suspect& one) { return is_held_by_wish(task, one.tag); });
  std::vector<TagFinding> findings;
  for (const Suspect& one : accused) {
    TagFinding finding = one.found.finding;
    if (accused.size() > 1) {
      if (one.tag == (held == accused.end() ? -1 : held->tag)) continue;
      finding.is_left_out = true;
      finding.blame = TagFinding::Blame::kThisOrAnother;
      for (const Suspect& other : accused)
        if (other.tag != one.tag) finding.others.push_back({other.tag});
      if (held != accused.end()) {
        finding.blame = TagFinding::Blame::kThisOrOthersInMap;
        finding.others = {{held->tag}};
      }
    }
    findings.push_back(std::move(finding));
  }
  return findings;
}

/// The map without those that are accused.
std::unique_ptr<ExaminedMap> map_without(const PartTask& task, const Part& part, const ExaminedMap& map,
                                         std::vector<Suspect> accused, std::set<int>& bent,
                                         const ParallelFor& parallel) {
  const std::vector<TagFinding> found = findings_of(task, accused);
  std::vector<TagFinding> all = map.solved.findings;
  all.insert(all.end(), found.begin(), found.end());
  for (const TagFinding& finding : found) {
    if (finding.is_left_out && is_held_by_wish(task, finding.tag))
      throw HeldTagAtFault(with_rivals(task, part, map.solved, map.solved.findings, finding));
    if (!finding.is_left_out) bent.insert(finding.tag);
  }
  std::unique_ptr<ExaminedMap> rest;
  if (accused.size() == 1) {
    rest = std::move(accused.front().without);
  } else {
    AdjustedPart solved = map.solved;
    solved.findings = all;
    std::set<int> gone = tags_left_out(solved);
    gone.insert(bent.begin(), bent.end());
    if (solve_without(task, part, gone, solved, parallel))
      rest = examine(task, part, std::move(solved), bent, parallel);
  }
  if (!rest) throw NothingLeft(all, kTooLittleLeft);
  rest->solved.findings = std::move(all);
  return rest;
}

std::string name_of(const Observations& observations, int tag) {
  return to_string(observations.tags[static_cast<std::size_t>(tag)]);
}

}  // namespace

Outcome<AdjustedPart> adjust_part_or_most_of_it(const PartTask& task, const Part& part, int held_tag,
                                                const ParallelFor& parallel) {
  Outcome<AdjustedPart> first = adjust_part(task, part, held_tag, parallel);
  if (first || part.tags.size() < 3 || part.tags.size() > kMostTagsToldApart) return first;
  std::vector<std::optional<AdjustedPart>> trials(part.tags.size());
  parallel(trials.size(), [&](std::size_t i) {
    const auto rest = part_without(task, part, {part.tags[i]}, held_tag);
    if (!rest) return;
    Outcome<AdjustedPart> anew = adjust_part(task, rest->part, rest->held_tag, on_one_thread(task));
    if (anew && !anew->contradictions.are_there()) trials[i] = std::move(*anew);
  });
  const auto views_of = [](const std::optional<AdjustedPart>& one) {
    return one ? one->part.views.size() : std::size_t{0};
  };
  const auto best = std::ranges::max_element(trials, {}, views_of);
  if (!*best) return first;
  const int tag = part.tags[static_cast<std::size_t>(best - trials.begin())];
  AdjustedPart result = std::move(**best);
  result.findings = {fault_of(task, part, result, tag).finding};
  return result;
}

void leave_out_faulty_tags(const PartTask& task, const Part& part, const CameraParameters& cameras,
                           AdjustedPart& solved, const ParallelFor& parallel) {
  std::set<int> bent, cleared;
  for (const TagFinding& finding : solved.findings)
    if (!finding.is_left_out) bent.insert(finding.tag);
  std::unique_ptr<ExaminedMap> map = examine(task, part, solved, bent, parallel);
  while (map && map->robust.part.tags.size() > 2) {  // of two that disagree, either may be wrong
    std::vector<Suspect> suspects = suspects_in(task, *map, cleared, parallel);
    if (suspects.empty() || log_odds_of(cameras, task, *map) > map->worst_log_odds()) break;
    solve_without_each(task, part, *map, bent, suspects, parallel);
    const std::size_t num_cleared = cleared.size();
    for (const Suspect& one : suspects)
      if (!is_why(one, *map)) cleared.insert(one.tag);
    std::erase_if(suspects, [&](const Suspect& one) { return cleared.contains(one.tag); });
    if (suspects.empty() && cleared.size() > num_cleared) continue;
    if (suspects.empty()) break;
    map = map_without(task, part, *map, accused_of(std::move(suspects)), bent, parallel);
  }
  if (!map || map->solved.findings.size() == solved.findings.size()) return;
  solved = map->solved;
  if (!bent.empty() && !solve_without(task, part, tags_left_out(solved), solved, parallel))
    throw NothingLeft(map->solved.findings, kTooLittleLeft);
}

NoMap contradictory(const Observations& observations, const Contradictions& contradictions) {
  std::vector<std::string> all;
  for (const int tag : contradictions.tags) all.push_back(name_of(observations, tag));
  for (const auto& [a, b] : contradictions.links)
    all.push_back(fmt::format("{} with {}", name_of(observations, a), name_of(observations, b)));
  const std::size_t told = std::min(all.size(), kMostTold);
  const std::string what =
      fmt::format("{}{}", fmt::join(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(told), ", "),
                  all.size() > told ? fmt::format(" and {} more", all.size() - told) : "");
  return {
      fmt::format("{} of {} frames contradict the others, and no one tag is clearly the cause; "
                  "most contradicted: {}. Does an id hang in two places? {}",
                  contradictions.contradicting, contradictions.frames, what, kWhatToCheck)};
}

}  // namespace apriltrack
