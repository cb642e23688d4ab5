#include "faults/tag_moves.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "apriltrack/base/parallel.h"
#include "faults/moves_of_tag.h"
#include "faults/split_tag.h"
#include "faults/tag_neighbourhoods.h"
#include "faults/tag_places.h"
#include "numerics/upper_median.h"
#include "uncertainty/noise_scale.h"
#include "uncertainty/viewpoint_shares.h"

namespace apriltrack {
namespace {

// Squares of six numbers, at the best of two dozen moments; of twelve, at the best two. What chance gives in
// the median, and what it hardly ever gives.
constexpr double kUsualOnce = 11.0, kUsualTwice = 20.0;
constexpr double kClearOnce = 60.0, kClearTwice = 100.0;
// What is worth a solve that shows how much the move hides: squares, and times what others show. (By the
// noise of two places alone, errors that blocks of frames share would be moves.)
constexpr double kWorthTwoPlaces = 45.0, kBesideOthers = 2.0;
constexpr std::size_t kMostInTwoPlaces = 2;
constexpr std::size_t kLeastOthers = 3;
constexpr std::size_t kMostFramesAsked = 250;  // of a tag; and as many others
// What a second move explains further: beyond chance, and beyond what the first, linearised, leaves.
constexpr double kClearAgain = 22.0, kAgain = 0.1;
// Over 1 is clear where nothing is known; of a tag that did move, a second move is likelier. Halves of tags
// that moved once reach 0.31, of loose ones 0.33 to 1.9.
constexpr double kClearAfterOne = 0.4, kClearRest = 0.5;
// Of places after every moment: standard deviations of the sum of squares, many, for tags differ in more than
// chance (errors that neighbouring frames share, lamps, shadows: up to 12 of them where nothing moved); and
// what is usual of others at least, by chance 1 (one that moves all the time makes all views seem noisy, so
// others show less).
constexpr double kClearAlways = 15.0, kLeastUsual = 0.5;

/// Where the tag seems to have moved once, where twice, and all the time.
struct Suspicion {
  Move once, twice, always;
  bool is_asked = false;                                  ///< It has views enough, which determine its pose.
  double of_once = 0.0, of_twice = 0.0, of_always = 0.0;  ///< Over 1: beyond chance, and what others show.
  std::optional<bool> moves_again;                        ///< Given two places, if that was tried.
  double explained_squares = 0.0;                         ///< Of `once`, by the noise of the map as it is.
  double usual_always = 1.0;  ///< Squares for each number of `always`, as others show them.

  double largest() const { return std::max({of_once, of_twice, of_always}); }
};

/// Squares for each number of a place after every moment.
double mean_square(const Move& always) {
  return always.squares / static_cast<double>(std::max<Eigen::Index>(always.changes.size(), 1));
}

/// The median of what all but `own` tags show; infinite where they are few.
template <class Value>
double median_of_others(const std::vector<Suspicion>& suspicions, const std::set<int>& own,
                        const Value& value) {
  std::vector<double> others;
  for (const Suspicion& one : suspicions) {
    if (!own.contains(one.once.tag) && one.is_asked) others.push_back(value(one));
  }
  if (others.size() < kLeastOthers) return std::numeric_limits<double>::infinity();
  return upper_median(std::move(others));
}

/// Over 1: clear.
double beyond_others(const Move& always, double usual) {
  const auto num = static_cast<double>(always.changes.size());
  if (num == 0.0) return 0.0;
  return (always.squares / (usual * num) - 1.0) / (kClearAlways * std::sqrt(2.0 / num));
}

/// How much more than by chance a tag seems to move, and more than others do, which are all but `own` of
/// them: neighbouring frames repeat their errors, and what a lens does to all tags is no move.
void compare(const std::vector<Suspicion>& suspicions, const std::set<int>& own, Suspicion& one) {
  const auto excess_of_others = [&](Move Suspicion::*which, double usual) {
    const auto squares = [&](const Suspicion& other) { return (other.*which).squares; };
    return std::max(1.0, median_of_others(suspicions, own, squares) / usual);
  };
  one.of_once = one.once.squares / (kClearOnce * excess_of_others(&Suspicion::once, kUsualOnce));
  one.of_twice = one.twice.squares / (kClearTwice * excess_of_others(&Suspicion::twice, kUsualTwice));
  const auto of_number = [](const Suspicion& other) { return mean_square(other.always); };
  one.usual_always = std::max(kLeastUsual, median_of_others(suspicions, own, of_number));
  one.of_always = beyond_others(one.always, one.usual_always);
}

/// Of nothing where the views leave a pose undetermined.
Suspicion suspicion_of(const PartTask& task, const MapState& state, const LinearPart& part, int tag) {
  Suspicion one;
  one.once.tag = one.twice.tag = one.always.tag = tag;
  if (!part.poses) return one;
  const MovesOfTag moves(part, tag);
  one.once = moves.with_one_more(moves.none());
  one.twice = moves.with_one_more(one.once);
  one.always = moves.all();
  const double share = mean_viewpoint_share(task.observations, state, part.part.views, tag);
  for (Move* move : {&one.once, &one.twice, &one.always}) move->squares *= share;
  one.explained_squares = one.once.squares;
  one.is_asked = one.always.changes.size() > 0;
  return one;
}

/// A tag that moves makes its frames and views seem noisy, which would hide it. But no view counts for more
/// than one that is three sigmas off.
MapState with_one_noise(MapState state) {
  constexpr double kMostSquares = 8.0 * 9.0;
  std::vector<double> of_view = std::move(state.noise.of_view);
  for (double& scale : of_view) {
    const double squares = (kTailFreedom + 8.0) * scale * scale - kTailFreedom;
    scale = std::sqrt(std::max(1.0, squares / kMostSquares));
  }
  state.noise = state.noise.of_all();
  state.noise.of_view = std::move(of_view);
  return state;
}

/// The tag, and what is near it, linearised.
LinearPart linear_around(const PartTask& task, const AdjustedPart& solved,
                         const TagNeighbourhoods& neighbourhoods, int tag) {
  if (neighbourhoods.are_all_one()) return {task, with_one_noise(solved.state), solved.part, solved.held_tag};
  return {task, with_one_noise(solved.state), neighbourhoods.around(tag), tag};
}

std::vector<Suspicion> suspicions_of(const PartTask& task, const AdjustedPart& solved,
                                     const TagNeighbourhoods& neighbourhoods, const ParallelFor& parallel) {
  std::optional<LinearPart> whole;
  if (neighbourhoods.are_all_one())
    whole.emplace(task, with_one_noise(solved.state), solved.part, solved.held_tag);
  std::vector<Suspicion> result(solved.part.tags.size());
  parallel(result.size(), [&](std::size_t i) {
    const int tag = solved.part.tags[i];
    result[i] = whole
                    ? suspicion_of(task, solved.state, *whole, tag)
                    : suspicion_of(task, solved.state, linear_around(task, solved, neighbourhoods, tag), tag);
  });
  for (Suspicion& one : result) compare(result, {one.once.tag}, one);
  return result;
}

std::vector<Suspicion> suspicions_of(const PartTask& task, const AdjustedPart& solved,
                                     const ParallelFor& parallel) {
  return suspicions_of(task, solved, TagNeighbourhoods(task.observations, solved.part, kMostFramesAsked),
                       parallel);
}

/// What moves again, or all the time, has no place.
bool is_loose(const Suspicion& one) {
  if (one.moves_again) return *one.moves_again;
  if (one.of_once < 1.0) return true;
  const double least = kAgain * one.once.squares;
  if (one.twice.squares - one.once.squares > std::max(kClearAgain, least)) return true;
  Move rest = one.always;
  rest.squares -= one.once.squares;
  return beyond_others(rest, one.usual_always) > kClearRest && rest.squares > least;
}

double size_m_of(const PartTask& task, int tag) {
  return task.observations.sizes_m[static_cast<std::size_t>(tag)];
}

bool is_too_small(const PartTask& task, const Move& move) {
  const Vector6d change = move.first_change();
  return change.head<3>().norm() < least_shift_m(Pose::exp(change), size_m_of(task, move.tag));
}

/// Beyond chance and beyond others; and far enough to matter.
bool is_clear(const PartTask& task, const Suspicion& one) {
  return one.largest() >= 1.0 && (is_loose(one) || !is_too_small(task, one.once));
}

std::vector<bool> is_at_second_of(const Move& move) {
  std::vector<bool> result(move.views.size());
  if (move.moments.empty()) return result;  // no change of place explains anything
  std::fill(result.begin() + static_cast<std::ptrdiff_t>(move.moments.front()), result.end(), true);
  return result;
}

bool does_any_move_again(const std::vector<Suspicion>& all, const std::set<int>& tags) {
  return std::ranges::any_of(all, [&](const Suspicion& one) {
    return tags.contains(one.once.tag) && one.largest() > kClearAfterOne;
  });
}

/// The map with two places for a tag; nullopt where it keeps but one of them.
std::optional<AdjustedPart> solve_with_two_places(const PartTask& of_two,
                                                  const std::vector<std::size_t>& views, int tag) {
  auto anew = solve_anew(of_two, views, tag);
  const int second = static_cast<int>(of_two.observations.tags.size()) - 1;
  if (!anew || !std::ranges::binary_search(anew->part.tags, tag) ||
      !std::ranges::binary_search(anew->part.tags, second))
    return std::nullopt;
  return anew;
}

/// A tag that moved makes all views seem noisy, and others seem to move with it. Judges it by the noise and
/// by the others of a map where it has two places: these are as they are without the move. nullopt where
/// there is no such map.
std::optional<Suspicion> judge_by_two_places(const PartTask& task, const AdjustedPart& solved,
                                             const TagNeighbourhoods& neighbourhoods, const Move& move,
                                             const ParallelFor& parallel) {
  Observations split = split_tag(task.observations, move.tag, move.views, is_at_second_of(move));
  split.cameras = solved.state.cameras;
  const PartTask of_two{split, task.candidates, task.options};
  const std::vector<std::size_t> views =
      neighbourhoods.are_all_one() ? solved.part.views : neighbourhoods.around(move.tag).views;
  const auto anew = solve_with_two_places(of_two, views, move.tag);
  if (!anew) return std::nullopt;
  const LinearPart by_two(of_two, with_one_noise(anew->state), anew->part, anew->held_tag);
  MapState state = solved.state;
  state.noise = anew->state.noise;
  LinearPart part(task, with_one_noise(state),
                  connected_to(task.observations, anew->part.views, move.tag, task.options.min_views),
                  move.tag);
  if (!by_two.poses || !part.poses) return std::nullopt;
  part.scale = by_two.scale;
  Suspicion one = suspicion_of(task, state, part, move.tag);
  one.explained_squares = move.squares;
  // The noise knows what frames repeat. But it may be a step that they repeat, like a move.
  for (Move* some : {&one.once, &one.twice, &one.always})
    some->squares /= by_two.scale.views_per_independent_view;
  const std::set<int> halves{move.tag, static_cast<int>(task.observations.tags.size())};
  const std::vector<Suspicion> all = suspicions_of(of_two, *anew, parallel);
  compare(all, halves, one);
  one.moves_again = does_any_move_again(all, halves);
  return one;
}

/// Those that stand out most by how they seem to have moved once.
std::vector<Move> moves_worth_two_places(const std::vector<Suspicion>& all) {
  std::vector<Move> moves;
  for (const Suspicion& one : all) {
    const auto squares = [](const Suspicion& other) { return other.once.squares; };
    const double least =
        std::max(kWorthTwoPlaces, kBesideOthers * median_of_others(all, {one.once.tag}, squares));
    if (!one.once.moments.empty() && one.once.squares > least) moves.push_back(one.once);
  }
  std::ranges::sort(moves, std::greater<>(), &Move::squares);
  moves.resize(std::min(moves.size(), kMostInTwoPlaces));
  return moves;
}

/// Where none is, perhaps one of the likeliest is when it is judged by two places.
std::vector<Suspicion> clear_suspicions(const PartTask& task, const AdjustedPart& solved,
                                        const ParallelFor& parallel) {
  const TagNeighbourhoods neighbourhoods(task.observations, solved.part, kMostFramesAsked);
  const std::vector<Suspicion> all = suspicions_of(task, solved, neighbourhoods, parallel);
  std::vector<Suspicion> clear;
  std::ranges::copy_if(all, std::back_inserter(clear), [&](const auto& one) { return is_clear(task, one); });
  if (!clear.empty()) return clear;
  for (const Move& move : moves_worth_two_places(all)) {
    const auto one = judge_by_two_places(task, solved, neighbourhoods, move, parallel);
    if (one && one->of_once >= 1.0 && is_clear(task, *one)) clear.push_back(*one);
  }
  return clear;
}

TwoPlaces places_of(const Move& move, const AdjustedPart& solved) {
  TwoPlaces two{};
  two.fit.T_map_tag = solved.state.T_map_tag[static_cast<std::size_t>(move.tag)];
  two.second.T_map_tag = two.fit.T_map_tag * Pose::exp(move.first_change());
  two.is_at_second = is_at_second_of(move);
  return two;
}

/// Half of what is beyond chance, less a fee for each unknown.
double explained_by(const Suspicion& one) {
  const auto num = static_cast<double>(one.always.changes.size());
  const double by_always = one.of_always > 1.0 ? 0.5 * (one.always.squares - one.usual_always * num) : 0.0;
  return std::max(0.5 * one.explained_squares, by_always) - 7.0 * kFeeOfUnknown;
}

TagFinding to_finding(const PartTask& task, const AdjustedPart& solved, const Suspicion& one) {
  const Move& move = one.once;
  std::vector<Timestamp> times;
  for (const std::size_t i : move.views)
    times.push_back(task.observations.frames[static_cast<std::size_t>(task.observations.views[i].frame)]);
  const std::vector<bool> is_at_second = is_at_second_of(move);
  TagFinding finding;
  for (std::size_t i = 0; i < move.views.size() && !is_loose(one); ++i)
    finding.views_by_place[is_at_second[i] ? 1 : 0].push_back(move.views[i]);
  finding.tag = move.tag;
  finding.is_left_out = true;
  finding.num_views = move.views.size();
  finding.explained = explained_by(one);
  finding.kind = is_loose(one) ? TagFinding::Kind::kLoose : TagFinding::Kind::kMoved;
  if (!is_loose(one)) finding.places = change_at_a_moment(places_of(move, solved), times);
  return finding;
}

}  // namespace

std::optional<TagFinding> find_hidden_move(const PartTask& task, const AdjustedPart& solved,
                                           const ParallelFor& parallel) {
  const std::vector<Suspicion> clear = clear_suspicions(task, solved, parallel);
  if (clear.empty()) return std::nullopt;
  return to_finding(task, solved, *std::ranges::max_element(clear, {}, &Suspicion::largest));
}

bool do_move_again(const PartTask& task, const AdjustedPart& solved, const std::set<int>& tags,
                   const ParallelFor& parallel) {
  return does_any_move_again(suspicions_of(task, solved, parallel), tags);
}

}  // namespace apriltrack
