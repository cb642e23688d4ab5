#include "tag_moves.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "moves_of_tag.h"
#include "tag_fault_words.h"
#include "tag_neighbourhoods.h"
#include "tag_places.h"

namespace apriltrack {
namespace {

// Squares of six numbers, at the best of two dozen moments; of twelve, at the best two. What chance gives in
// the median, and what it hardly ever gives.
constexpr double kUsualOnce = 11.0, kUsualTwice = 20.0;
constexpr double kClearOnce = 60.0, kClearTwice = 100.0;
constexpr std::size_t kLeastOthers = 3;
constexpr std::size_t kMostFramesAsked = 250;  // of a tag; and as many others
// What a second move explains further: beyond chance, and beyond what the first, linearised, leaves.
constexpr double kClearAgain = 35.0, kAgain = 0.1;

/// Where the tag seems to have moved once, and where twice.
struct Suspicion {
  Move once, twice;
  bool is_determined = false;
  double of_once = 0.0, of_twice = 0.0;  ///< Over 1: beyond chance, and beyond what the others show.

  double largest() const { return std::max(of_once, of_twice); }
};

/// How much more than by chance the others seem to move: neighbouring frames repeat their errors, and what a
/// lens does to all tags is no move.
double excess_of_others(const std::vector<Suspicion>& suspicions, const Suspicion& own,
                        Move Suspicion::*which, double usual) {
  std::vector<double> others;
  for (const Suspicion& one : suspicions) {
    if (&one != &own && one.is_determined) others.push_back((one.*which).squares);
  }
  if (others.size() < kLeastOthers) return std::numeric_limits<double>::infinity();
  const auto middle = others.begin() + static_cast<std::ptrdiff_t>(others.size() / 2);
  std::ranges::nth_element(others, middle);
  return std::max(1.0, *middle / usual);
}

/// Of nothing where the views leave a pose undetermined.
Suspicion suspicion_of(const LinearPart& part, int tag) {
  Suspicion one;
  one.once.tag = one.twice.tag = tag;
  if (!part.poses) return one;
  one.is_determined = true;
  const MovesOfTag moves(part, tag);
  one.once = moves.with_one_more(moves.none());
  one.twice = moves.with_one_more(one.once);
  return one;
}

std::vector<Suspicion> suspicions_of(const PartTask& task, const AdjustedPart& solved,
                                     const ParallelFor& parallel) {
  const TagNeighbourhoods neighbourhoods(task.observations, solved.part, kMostFramesAsked);
  std::optional<LinearPart> whole;
  if (neighbourhoods.are_all_one()) whole.emplace(task, solved.state, solved.part, solved.held_tag);
  std::vector<Suspicion> result(solved.part.tags.size());
  parallel(result.size(), [&](std::size_t i) {
    const int tag = solved.part.tags[i];
    result[i] = whole ? suspicion_of(*whole, tag)
                      : suspicion_of({task, solved.state, neighbourhoods.around(tag), tag}, tag);
  });
  for (Suspicion& one : result) {
    one.of_once =
        one.once.squares / (kClearOnce * excess_of_others(result, one, &Suspicion::once, kUsualOnce));
    one.of_twice =
        one.twice.squares / (kClearTwice * excess_of_others(result, one, &Suspicion::twice, kUsualTwice));
  }
  return result;
}

double size_m_of(const PartTask& task, int tag) {
  return task.observations.sizes_m[static_cast<std::size_t>(tag)];
}

TwoPlaces places_of(const Move& move, const AdjustedPart& solved) {
  TwoPlaces two{};
  two.fit.T_map_tag = solved.state.T_map_tag[static_cast<std::size_t>(move.tag)];
  two.second.T_map_tag = two.fit.T_map_tag * Pose::exp(move.first_change());
  for (std::size_t i = 0; i < move.views.size(); ++i) two.is_at_second.push_back(i >= move.moments.front());
  return two;
}

TagFinding to_finding(const PartTask& task, const AdjustedPart& solved, const Move& move, bool is_loose) {
  std::vector<ProbeView> when;
  for (const std::size_t i : move.views) {
    const TagView& view = task.observations.views[i];
    ProbeView probe;
    probe.view = &view;
    probe.timestamp = task.observations.frames[static_cast<std::size_t>(view.frame)];
    when.push_back(probe);
  }
  const std::string name = to_string(task.observations.tags[static_cast<std::size_t>(move.tag)]);
  TagFinding finding;
  finding.tag = move.tag;
  finding.is_left_out = true;
  finding.num_views = move.views.size();
  finding.explained = 0.5 * move.squares - 7.0 * kFeeOfUnknown;
  finding.kind = is_loose ? TagFinding::Kind::kLoose : TagFinding::Kind::kMoved;
  finding.words = is_loose
                      ? words_of_loose(name)
                      : words_of_move(places_of(move, solved), when, task.observations.frames.front(), name);
  return finding;
}

}  // namespace

std::optional<TagFinding> find_hidden_move(const PartTask& task, const AdjustedPart& solved,
                                           const ParallelFor& parallel) {
  const std::vector<Suspicion> suspicions = suspicions_of(task, solved, parallel);
  const Suspicion& most = *std::ranges::max_element(suspicions, {}, &Suspicion::largest);
  if (most.largest() < 1.0) return std::nullopt;
  // What moves again has no place.
  const Move& best = most.once;
  const bool is_loose =
      most.of_once < 1.0 || most.twice.squares - best.squares > std::max(kClearAgain, kAgain * best.squares);
  const double shift_m = best.first_change().head<3>().norm();
  if (!is_loose && shift_m < least_shift_m(Pose::exp(best.first_change()), size_m_of(task, best.tag)))
    return std::nullopt;
  return to_finding(task, solved, best, is_loose);
}

}  // namespace apriltrack
