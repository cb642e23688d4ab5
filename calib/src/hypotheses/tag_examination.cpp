#include "hypotheses/tag_examination.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "apriltrack/base/error.h"
#include "faults/part_without.h"
#include "faults/tag_moves.h"
#include "faults/tag_shapes.h"
#include "faults/tag_suspects.h"
#include "faults/tag_trials.h"
#include "hypotheses/part_failure.h"
#include "hypotheses/print_batches.h"
#include "hypotheses/rivals.h"
#include "hypotheses/undecided_tags.h"

namespace apriltrack {
namespace {

constexpr int kMostFaults = 4;
constexpr std::size_t kMostSuspectsExamined = 6;

struct Absence {
  TagFinding finding;  ///< Of the tag that was left out.
  AdjustedPart rest;
  std::size_t num_others = 0;  ///< That still seem at fault.
};

/// And without those that are `known`, and not in the map.
bool solve_without(const PartTask& task, const Part& part, int tag, const std::set<int>& known,
                   AdjustedPart& solved, const ParallelFor& parallel) {
  return solve_without(task, part, tags_out(solved, {tag}, known), solved, parallel);
}

/// Null where nothing is wrong with the tag by the map without it, nor by the one with it: without a tag that
/// joins two pieces of the map, few views of it are left to look at.
std::unique_ptr<Absence> look_without(const PartTask& task, const Part& part, const AdjustedPart& solved,
                                      int tag, std::set<int> known, const ParallelFor& parallel) {
  auto trial = std::make_unique<Absence>();
  trial->rest = solved;
  if (!solve_without(task, part, tag, known, trial->rest, parallel)) return nullptr;
  std::array<TagLook, 2> looks;
  std::atomic<bool> is_found = false;
  parallel(looks.size(), [&](std::size_t i) {
    if (!is_found) looks[i] = look_by(task, part, i == 0 ? trial->rest : solved, tag);
    if (i == 0 && looks[i].finding) is_found = true;
  });
  TagLook& look = looks[looks[0].finding ? 0 : 1];
  if (!look.finding) return nullptr;
  if (look.finding->kind == TagFinding::Kind::kLoose && !does_disturb(task, part, solved, tag))
    return nullptr;
  trial->finding = std::move(*look.finding);
  known.insert(tag);
  trial->num_others = suspects_in(task, part, trial->rest, known, parallel).size();
  return trial;
}

/// That leaves the fewest tags that seem wrong, and explains most.
std::unique_ptr<Absence> best_absence(const PartTask& task, const Part& part, const AdjustedPart& solved,
                                      const std::vector<int>& suspects, const std::set<int>& known,
                                      const ParallelFor& parallel) {
  std::vector<std::unique_ptr<Absence>> trials(suspects.size());
  const ParallelFor within = suspects.size() > 1 ? on_one_thread(task) : parallel;
  parallel(suspects.size(),
           [&](std::size_t i) { trials[i] = look_without(task, part, solved, suspects[i], known, within); });
  std::erase(trials, nullptr);
  const auto rank = [](const std::unique_ptr<Absence>& one) {
    return std::pair(one->num_others, -one->finding.gain());
  };
  const auto best = std::ranges::min_element(trials, {}, rank);
  return best == trials.end() ? nullptr : std::move(*best);
}

/// Of a tag that was left out before: the frames contradicted each other with it, or leave it two poses.
std::optional<TagFinding> look_at_left_out(const PartTask& task, const Part& part, const AdjustedPart& solved,
                                           int tag) {
  auto finding = look_by(task, part, solved, tag).finding;
  if (finding) finding->is_left_out = true;
  return finding;
}

/// A map cannot be held by a tag that must not be in it.
void require_sound_held_tag(const PartTask& task, const Part& part, const AdjustedPart& solved,
                            const std::vector<TagFinding>& known, const TagFinding& finding) {
  if (!finding.is_left_out || !is_held_by_wish(task, finding.tag)) return;
  throw HeldTagAtFault(with_rivals(task, part, solved, known, finding));
}

/// What no frame tells by itself: a wrong size may pass for a move, and a move for a bend.
std::optional<TagFinding> find_hidden_fault(const PartTask& task, const AdjustedPart& sound,
                                            const ParallelFor& parallel) {
  auto move = find_hidden_move(task, sound, parallel);
  auto shape = find_odd_shape(task, sound);
  if (!move || !shape) return move ? move : shape;
  return move->explained > shape->explained ? move : shape;
}

/// A sound map, and the same by the sizes that tags of two prints have where it looks as if there were two:
/// where these meet, a tag of either seems to have moved, or to have a size of its own.
class AsPrinted {
 public:
  AsPrinted(const PartTask& task, const Part& part, const AdjustedPart& sound, const std::set<int>& known,
            const ParallelFor& parallel)
      : as_stated_(task), sound_(sound) {
    const auto batches = find_print_batches(task, sound);
    if (!batches) return;
    observations_ = task.observations;
    observations_->sizes_m = sizes_as_printed(task.observations, *batches);
    by_prints_ = sound;
    if (!solve_without(this->task(), part, tags_out(sound, {}, known), *by_prints_, parallel))
      observations_.reset();
  }

  bool are_two() const { return observations_.has_value(); }
  PartTask task() const {
    return {are_two() ? *observations_ : as_stated_.observations, as_stated_.candidates, as_stated_.options};
  }
  const AdjustedPart& sound() const { return are_two() ? *by_prints_ : sound_; }

 private:
  const PartTask& as_stated_;
  const AdjustedPart& sound_;
  std::optional<Observations> observations_;
  std::optional<AdjustedPart> by_prints_;
};

/// Tags that were found bent stay in the map; but others are held against a map without them.
void examine_by_all_views(const PartTask& task, const Part& part, AdjustedPart& solved, std::set<int>& known,
                          std::vector<TagFinding>& findings, const ParallelFor& parallel) {
  AdjustedPart sound = solved;
  for (const int tag : known) {
    if (std::ranges::binary_search(sound.part.tags, tag) &&
        !solve_without(task, part, tag, known, sound, parallel))
      return;
  }
  for (int round = 0; round < kMostFaults; ++round) {
    const AsPrinted printed(task, part, sound, known, parallel);
    auto finding = find_hidden_fault(printed.task(), printed.sound(), parallel);
    if (!finding) return;
    require_sound_held_tag(task, part, solved, findings, *finding);
    const int tag = finding->tag;
    AdjustedPart rest = sound;
    const bool is_sound = solve_without(task, part, tag, known, rest, parallel);
    // What was estimated to first order is told better from the map without it, where frames tell.
    auto better = is_sound ? look_by(task, part, rest, tag).finding : std::nullopt;
    const bool is_better = better && better->kind == finding->kind;
    if (printed.are_two() && finding->kind == TagFinding::Kind::kSize && !is_better)
      return;  // of another size than a print's, which nobody stated
    if (finding->is_left_out && !solve_without(task, part, tag, known, solved, parallel))
      throw NothingLeft({*finding}, kTooLittleLeft);
    known.insert(tag);
    findings.push_back(is_better ? std::move(*better) : std::move(*finding));
    if (!is_sound) return;
    sound = std::move(rest);
  }
}

std::vector<int> tags_but(std::vector<int> tags, const std::set<int>& known) {
  std::erase_if(tags, [&](int tag) { return known.contains(tag); });
  return tags;
}

/// Without those culprits of which frames of three tags do not tell: they may have been accused in the place
/// of another.
AdjustedPart without_doubtful_culprits(const PartTask& task, const Part& part, AdjustedPart solved,
                                       const std::set<int>& known) {
  std::vector<int> culprits = solved.culprits;
  std::erase_if(culprits, [&](int culprit) {
    return !known.contains(culprit) && !do_frames_tell(task, part, solved, culprit);
  });
  solved.culprits = std::move(culprits);
  return solved;
}

/// `rest` without some tags and its culprits. nullopt where contradictions are left, Error(kNoResult) where
/// nothing is that agrees and is decided.
std::optional<AdjustedPart> adjust_without_faults(const PartTask& task, const Part& part, AdjustedPart rest,
                                                  const std::vector<TagFinding>& faults,
                                                  const ParallelFor& parallel) {
  std::set<int> gone(rest.culprits.begin(), rest.culprits.end());
  for (const TagFinding& fault : faults) gone.insert(fault.tag);
  if (!solve_without(task, part, gone, rest, parallel)) throw NothingLeft(faults, kTooLittleLeft);
  if (rest.contradictions.are_there()) return std::nullopt;
  rest.undecided.clear();
  if (const auto failure = leave_out_undecided(task, part, rest, parallel))
    throw NothingLeft(faults, failure->cause);
  return rest;
}

bool has_culprit(const AdjustedPart& solved, const std::vector<TagFinding>& faults) {
  return std::ranges::any_of(faults, [&](const TagFinding& fault) {
    return std::ranges::find(solved.culprits, fault.tag) != solved.culprits.end();
  });
}

/// What explains most; or, where that leaves contradictions, a fault of a culprit, without which there are
/// none.
std::optional<std::pair<std::vector<TagFinding>, AdjustedPart>> best_by_trial(const PartTask& task,
                                                                              const AdjustedPart& solved,
                                                                              const Part& part,
                                                                              const std::set<int>& known,
                                                                              const ParallelFor& parallel) {
  const Part without_known = narrowed_to(task.observations, part, tags_but(part.tags, known));
  const AdjustedPart start = without_doubtful_culprits(task, part, solved, known);
  bool is_first = true;
  for (std::vector<TagFinding>& faults : find_faults_by_trial(task, without_known, solved, parallel)) {
    const bool was_first = std::exchange(is_first, false);
    if (!was_first && !has_culprit(solved, faults)) continue;
    // Of several that would do the one that the user holds is trusted.
    if (faults.size() > 1)
      std::erase_if(faults, [&](const TagFinding& fault) { return is_held_by_wish(task, fault.tag); });
    for (const TagFinding& fault : faults) require_sound_held_tag(task, part, solved, solved.rivals, fault);
    try {
      if (auto rest = adjust_without_faults(task, part, start, faults, parallel))
        return std::pair(std::move(faults), std::move(*rest));
    } catch (const Error&) {
      if (was_first) throw;  // of the others there is a map without
    }
  }
  return std::nullopt;
}

/// Before others are held against a map that lacks what they explain: they may have been accused in their
/// place, and may be why others are undecided.
void leave_out_by_trial(const PartTask& task, const Part& part, AdjustedPart& solved, std::set<int>& known,
                        std::vector<TagFinding>& findings, const ParallelFor& parallel) {
  auto best = best_by_trial(task, solved, part, known, parallel);
  if (!best) return;
  solved = std::move(best->second);
  for (TagFinding& fault : best->first) {
    known.insert(fault.tag);
    std::erase(solved.undecided, fault.tag);
    findings.push_back(std::move(fault));
  }
}

}  // namespace

std::vector<TagFinding> examine_tags(const PartTask& task, const Part& part, AdjustedPart& solved,
                                     const ParallelFor& parallel) {
  std::vector<TagFinding> findings = solved.rivals;
  if (part.tags.size() < 3) return findings;  // of two that disagree, either may be wrong
  std::set<int> known;
  for (const TagFinding& rival : solved.rivals) known.insert(rival.tag);
  leave_out_by_trial(task, part, solved, known, findings, parallel);
  std::vector<int> left_out = solved.culprits;
  left_out.insert(left_out.end(), solved.undecided.begin(), solved.undecided.end());
  for (const int tag : left_out) {
    if (!known.insert(tag).second) continue;
    if (auto finding = look_at_left_out(task, part, solved, tag)) findings.push_back(std::move(*finding));
  }
  AdjustedPart sound = solved;  // without bent ones, too, which stay in the map
  for (int round = 0; round < kMostFaults; ++round) {
    std::vector<int> suspects = suspects_in(task, part, sound, known, parallel);
    suspects.resize(std::min(suspects.size(), kMostSuspectsExamined));
    std::unique_ptr<Absence> best = best_absence(task, part, sound, suspects, known, parallel);
    if (!best) break;
    TagFinding& finding = best->finding;
    if (finding.kind == TagFinding::Kind::kLoose)
      finding = places_or_loose(task, part, best->rest, std::move(finding));
    require_sound_held_tag(task, part, best->rest, findings, finding);
    const bool are_bent_in_map = sound.part.tags != solved.part.tags;
    sound = std::move(best->rest);
    if (finding.is_left_out && !are_bent_in_map) {
      solved = sound;
    } else if (finding.is_left_out && !solve_without(task, part, finding.tag, known, solved, parallel)) {
      throw NothingLeft({finding}, kTooLittleLeft);
    }
    known.insert(finding.tag);
    findings.push_back(std::move(finding));
  }
  leave_out_rivals(task, part, solved, known, findings, parallel);  // or the map may be folded
  examine_by_all_views(task, part, solved, known, findings, parallel);
  leave_out_rivals(task, part, solved, known, findings, parallel);
  return findings;
}

}  // namespace apriltrack
