#include "tag_examination.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "apriltrack/base/error.h"
#include "undecided_tags.h"

namespace apriltrack {
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
    const TagLook look = look_at(task, probe_views(task, part, solved, tag), tag);
    if (look.misfit > kSuspicious || look.finding) suspects.emplace_back(-look.misfit, tag);
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

/// What is left to map without `tag`, and without those that were left out before.
std::vector<std::size_t> views_without(const PartTask& task, const Part& part, const AdjustedPart& solved,
                                       int tag, const std::set<int>& known) {
  std::vector<std::size_t> views = part.views;
  std::erase_if(views, [&](std::size_t v) {
    const int of_view = task.observations.views[v].tag;
    return of_view == tag || std::ranges::binary_search(solved.undecided, of_view) ||
           (known.contains(of_view) && !std::ranges::binary_search(solved.part.tags, of_view));
  });
  return views;
}

/// The map without a tag, from the start, for with the tag it may have been folded; by the cameras of
/// `solved`, which may have been refined. False where too little is left that agrees.
bool solve_without(const PartTask& task, const Part& part, int tag, const std::set<int>& known,
                   AdjustedPart& solved) {
  if (!hold_another(task, {tag}, solved)) return false;
  const Part rest = connected_to(task.observations, views_without(task, part, solved, tag, known),
                                 solved.held_tag, task.options.min_views);
  if (rest.tags.size() < 2) return false;
  Observations by_cameras = task.observations;
  by_cameras.cameras = solved.state.cameras;
  try {
    AdjustedPart anew =
        adjust_part({by_cameras, task.candidates, task.options}, rest, solved.held_tag, parallel_for(1));
    solved.part = std::move(anew.part);
    solved.state = std::move(anew.state);
    return true;
  } catch (const Error&) {
    return false;
  }
}

/// Null where nothing is wrong with the tag by the map without it, or where there is none.
std::unique_ptr<Absence> look_without(const PartTask& task, const Part& part, const AdjustedPart& solved,
                                      int tag, std::set<int> known) {
  auto trial = std::make_unique<Absence>();
  trial->rest = solved;
  if (!solve_without(task, part, tag, known, trial->rest)) return nullptr;
  const TagLook look = look_at(task, probe_views(task, part, trial->rest, tag), tag);
  if (!look.finding) return nullptr;
  trial->finding = *look.finding;
  known.insert(tag);
  trial->num_others = suspects_in(task, part, trial->rest, known).size();
  return trial;
}

/// Of a tag that was left out before, for the frames contradicted each other with it.
std::optional<TagFinding> look_at_culprit(const PartTask& task, const Part& part,
                                          const AdjustedPart& solved) {
  auto finding = look_at(task, probe_views(task, part, solved, *solved.culprit), *solved.culprit).finding;
  if (finding && !finding->is_left_out) {
    finding->words += ". It is left out";
    finding->is_left_out = true;
  }
  return finding;
}

}  // namespace

std::vector<TagFinding> examine_tags(const PartTask& task, const Part& part, AdjustedPart& solved) {
  std::vector<TagFinding> findings;
  if (part.tags.size() < 3) return findings;  // of two that disagree, either may be wrong
  std::set<int> known;
  if (solved.culprit) {
    known.insert(*solved.culprit);
    if (auto finding = look_at_culprit(task, part, solved)) findings.push_back(std::move(*finding));
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
