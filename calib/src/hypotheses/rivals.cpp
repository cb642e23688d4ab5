#include "hypotheses/rivals.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "apriltrack/base/error.h"
#include "apriltrack/base/parallel.h"
#include "faults/part_without.h"
#include "faults/rival_tags.h"
#include "hypotheses/fault_finding.h"
#include "hypotheses/part_failure.h"

namespace apriltrack {
namespace {

constexpr std::size_t kMostRivals = 3;  // that are left out for one tag

/// A tag, or a board of them, that may have changed its place instead of one that was found at two.
using Rival = std::set<int>;

std::vector<std::vector<int>> boards_of(const std::vector<Rival>& rivals) {
  std::vector<std::vector<int>> boards;
  for (const Rival& rival : rivals) boards.emplace_back(rival.begin(), rival.end());
  return boards;
}

/// Of each tag of a rival.
std::vector<TagFinding> findings_of(const PartTask& task, const Part& part, const AdjustedPart& solved,
                                    const TagFinding& finding, const Rival& rival, std::set<int> known,
                                    const ParallelFor& parallel) {
  known.erase(finding.tag);
  AdjustedPart other = solved;
  const bool is_solved = solve_without(task, part, tags_out(solved, rival, known), other, parallel);
  std::vector<TagFinding> findings;
  for (const int tag : rival) {
    std::optional<TagFinding> found;
    if (is_solved) found = fault_of(task, part, other, tag).finding;
    if (found && !found->views_by_place[0].empty()) {
      found->blame = TagFinding::Blame::kThisOrAnother;
    } else {
      found = TagFinding{.tag = tag,
                         .kind = finding.kind,
                         .blame = TagFinding::Blame::kJoinsPlacesOfAnother,
                         .others = boards_of({rival}),
                         .joined_tag = finding.tag};
    }
    found->is_left_out = true;
    findings.push_back(std::move(*found));
  }
  return findings;
}

/// What holds the map together, and would if those in doubt were in it.
Part ties_of(const Observations& observations, const Part& part, const Part& kept,
             const std::vector<TagFinding>& findings) {
  std::set<int> tags(kept.tags.begin(), kept.tags.end()), doubted;
  for (const TagFinding& finding : findings)
    if (finding.is_in_doubt()) doubted.insert(finding.tag);
  tags.insert(doubted.begin(), doubted.end());
  std::set<int> frames;
  for (const std::size_t v : part.views)
    if (doubted.contains(observations.views[v].tag)) frames.insert(observations.views[v].frame);
  Part ties{{tags.begin(), tags.end()}, {}};
  std::ranges::copy_if(part.views, std::back_inserter(ties.views), [&](std::size_t v) {
    const TagView& view = observations.views[v];
    return std::ranges::binary_search(kept.views, v) ||
           (frames.contains(view.frame) && tags.contains(view.tag));
  });
  return ties;
}

/// False where there are none.
bool leave_out_rivals_once(const PartTask& task, const Part& part, AdjustedPart& solved, std::set<int>& known,
                           std::vector<TagFinding>& findings, const ParallelFor& parallel) {
  const Part ties = ties_of(task.observations, part, solved.part, findings);
  const auto is_held = [&](const Rival& rival) {
    return std::ranges::any_of(rival, [&](int tag) { return is_held_by_wish(task, tag); });
  };
  std::vector<TagFinding> found;
  std::set<int> left_out, gone;
  for (TagFinding& finding : findings) {
    if (!finding.is_left_out) continue;
    std::vector<Rival> rivals = rival_tags(task.observations, part, ties, finding);
    if (rivals.empty()) continue;
    for (Rival& rival : rivals)
      std::erase_if(rival, [&](int tag) { return !std::ranges::binary_search(solved.part.tags, tag); });
    std::erase_if(rivals, [](const Rival& rival) { return rival.empty(); });
    if (rivals.size() > kMostRivals || std::ranges::any_of(rivals, is_held)) {
      finding.blame = TagFinding::Blame::kThisOrOthersInMap;
      finding.others = boards_of(rivals);
      continue;
    }
    if (!finding.is_in_doubt()) finding.blame = TagFinding::Blame::kThisOrAnother;
    for (Rival& rival : rivals) {
      std::erase_if(rival, [&](int tag) { return left_out.contains(tag); });
      if (rival.empty()) continue;
      left_out.insert(rival.begin(), rival.end());
      std::ranges::move(findings_of(task, part, solved, finding, rival, known, parallel),
                        std::back_inserter(found));
      gone.merge(tags_out(solved, rival, known));
    }
  }
  if (found.empty()) return false;
  known.insert(left_out.begin(), left_out.end());
  std::ranges::move(found, std::back_inserter(findings));
  if (!solve_without(task, part, gone, solved, parallel)) throw NothingLeft(findings, kTooLittleLeft);
  return true;
}

}  // namespace

void leave_out_rivals(const PartTask& task, const Part& part, AdjustedPart& solved,
                      const ParallelFor& parallel) {
  constexpr int kMostRounds = 3;  // of those that are left another may be the only joint
  std::vector<TagFinding> findings = std::move(solved.findings);
  solved.findings.clear();
  std::set<int> known(solved.undecided.begin(), solved.undecided.end());
  for (const TagFinding& finding : findings) known.insert(finding.tag);
  for (int round = 0; round < kMostRounds; ++round)
    if (!leave_out_rivals_once(task, part, solved, known, findings, parallel)) break;
  solved.findings = std::move(findings);
}

TagFinding with_rivals(const PartTask& task, const Part& part, const AdjustedPart& solved,
                       const std::vector<TagFinding>& known, TagFinding finding) {
  const Part ties = ties_of(task.observations, part, solved.part, known);
  const std::vector<Rival> rivals = rival_tags(task.observations, part, ties, finding);
  if (rivals.empty()) return finding;
  finding.blame = TagFinding::Blame::kThisOrOthersNoMap;
  finding.others = boards_of(rivals);
  return finding;
}

}  // namespace apriltrack
