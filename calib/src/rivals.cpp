#include "rivals.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "apriltrack/base/error.h"
#include "part_without.h"
#include "rival_tags.h"
#include "tag_examination.h"
#include "tag_fault_words.h"
#include "tag_suspects.h"

namespace apriltrack {
namespace {

constexpr std::size_t kMostRivals = 3;  // that are left out for one tag

std::string name_in(const Observations& observations, int tag) {
  return to_string(observations.tags[static_cast<std::size_t>(tag)]);
}

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
    const std::string words =
        words_of_joint(name_in(task.observations, rival), name_in(task.observations, finding.tag));
    result = TagFinding{.tag = rival, .kind = finding.kind, .words = words};
  }
  result->is_left_out = true;
  return *result;
}

std::vector<TagKey> keys_of(const Observations& observations, const std::vector<int>& tags) {
  std::vector<TagKey> keys;
  for (const int tag : tags) keys.push_back(observations.tags[static_cast<std::size_t>(tag)]);
  return keys;
}

}  // namespace

void leave_out_rivals(const PartTask& task, const Part& part, AdjustedPart& solved, std::set<int>& known,
                      std::vector<TagFinding>& findings, const ParallelFor& parallel) {
  std::vector<TagFinding> found;
  std::set<int> rivals, gone;
  for (TagFinding& finding : findings) {
    if (!finding.is_left_out) continue;
    std::vector<int> tags = rival_tags(task.observations, part, solved.part, finding);
    std::erase_if(tags, [&](int tag) { return is_held_by_wish(task, tag); });
    if (tags.empty()) continue;
    if (tags.size() > kMostRivals) {
      finding.words = words_of_many_rivals(finding.words, list_tags(keys_of(task.observations, tags)));
      continue;
    }
    finding.words = words_of_rival(finding.words);
    for (const int tag : tags) {
      if (!rivals.insert(tag).second) continue;
      found.push_back(rival_finding(task, part, solved, finding, tag, known, parallel));
      gone.merge(tags_out(solved, tag, known));
    }
  }
  if (found.empty()) return;
  known.insert(rivals.begin(), rivals.end());
  std::ranges::move(found, std::back_inserter(findings));
  if (!solve_without(task, part, gone, solved, parallel))
    fail_after(findings, no_result("calibrate", kTooLittleLeft));
}

}  // namespace apriltrack
