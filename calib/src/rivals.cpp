#include "rivals.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "apriltrack/base/error.h"
#include "calibration_words.h"
#include "part_without.h"
#include "rival_tags.h"
#include "tag_examination.h"
#include "tag_fault_words.h"
#include "tag_suspects.h"

namespace apriltrack {
namespace {

constexpr std::size_t kMostRivals = 3;  // that are left out for one tag

/// Of one that may have changed its place instead of the tag that was found at two.
TagFinding rival_finding(const PartTask& task, const Part& part, const AdjustedPart& solved,
                         const TagFinding& finding, int rival, std::set<int> known,
                         const ParallelFor& parallel) {
  known.erase(finding.tag);
  AdjustedPart other = solved;
  std::optional<TagFinding> result;
  if (solve_without(task, part, tags_out(solved, rival, known), other, parallel))
    result = look_by(task, part, other, rival).finding;
  if (result && !result->views_by_place[0].empty()) {
    result->words = words_of_rival(result->words);
  } else {
    const std::string words = words_of_joint(to_string(key_of(task.observations, rival)),
                                             to_string(key_of(task.observations, finding.tag)));
    result = TagFinding{.tag = rival, .kind = finding.kind, .words = words};
  }
  result->is_left_out = result->is_in_doubt = true;
  return *result;
}

/// What holds the map together, and would if those in doubt were in it.
Part ties_of(const Observations& observations, const Part& part, const Part& kept,
             const std::vector<TagFinding>& findings) {
  std::set<int> tags(kept.tags.begin(), kept.tags.end()), doubted;
  for (const TagFinding& finding : findings)
    if (finding.is_in_doubt) doubted.insert(finding.tag);
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
  std::vector<TagFinding> found;
  std::set<int> rivals, gone;
  for (TagFinding& finding : findings) {
    if (!finding.is_left_out) continue;
    std::vector<int> tags = rival_tags(task.observations, part, ties, finding);
    if (tags.empty()) continue;
    std::erase_if(tags, [&](int tag) { return !std::ranges::binary_search(solved.part.tags, tag); });
    const bool is_held = std::ranges::any_of(tags, [&](int tag) { return is_held_by_wish(task, tag); });
    finding.is_in_doubt = true;
    if (is_held || tags.size() > kMostRivals) {
      finding.words = words_of_rivals_in_map(finding.words, keys_of(task.observations, tags));
      finding.may_fold_map = true;
      continue;
    }
    finding.words = words_of_rival(finding.words);
    for (const int tag : tags) {
      if (!rivals.insert(tag).second) continue;
      found.push_back(rival_finding(task, part, solved, finding, tag, known, parallel));
      gone.merge(tags_out(solved, tag, known));
    }
  }
  if (found.empty()) return false;
  known.insert(rivals.begin(), rivals.end());
  std::ranges::move(found, std::back_inserter(findings));
  if (!solve_without(task, part, gone, solved, parallel))
    fail_after(findings, no_result("calibrate", kTooLittleLeft));
  return true;
}

}  // namespace

void leave_out_rivals(const PartTask& task, const Part& part, AdjustedPart& solved, std::set<int>& known,
                      std::vector<TagFinding>& findings, const ParallelFor& parallel) {
  constexpr int kMostRounds = 3;  // of those that are left another may be the only joint
  for (int round = 0; round < kMostRounds; ++round)
    if (!leave_out_rivals_once(task, part, solved, known, findings, parallel)) return;
}

std::string words_with_rivals(const PartTask& task, const Part& part, const AdjustedPart& solved,
                              const std::vector<TagFinding>& known, const TagFinding& finding) {
  const Part ties = ties_of(task.observations, part, solved.part, known);
  const std::vector<int> rivals = rival_tags(task.observations, part, ties, finding);
  return rivals.empty() ? finding.words
                        : words_of_rivals_instead(finding.words, keys_of(task.observations, rivals));
}

}  // namespace apriltrack
