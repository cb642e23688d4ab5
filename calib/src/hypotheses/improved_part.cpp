#include "hypotheses/improved_part.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "apriltrack/base/error.h"
#include "apriltrack/base/log.h"
#include "apriltrack/base/parallel.h"
#include "apriltrack/calib/calibration_options.h"
#include "faults/part_without.h"
#include "hypotheses/contradicted_tags.h"
#include "hypotheses/culprit_search.h"
#include "hypotheses/honest_edges.h"
#include "hypotheses/part_failure.h"
#include "hypotheses/tag_examination.h"
#include "hypotheses/undecided_tags.h"

namespace apriltrack {
namespace {

// Of tags and of their views: where more had to go for the file's lens to do, it does not.
constexpr double kMostInstead = 0.25;

/// Looks at each tag for faults, and leaves out what cannot be trusted. Whether that is any.
bool leave_out_faulty(const PartTask& task, const Part& part, const ParallelFor& parallel,
                      ImprovedPart& improved) {
  AdjustedPart& solved = improved.solved;
  const std::vector<int> tags_before = solved.part.tags;
  improved.findings = examine_tags(task, part, solved, parallel);
  improved.contradicted = leave_out_contradicted(task, part, solved);
  if (solved.part.tags == tags_before) return false;
  if (solved.contradictions.are_there())
    throw NothingLeft(improved.findings, contradictory(task.observations, solved.contradictions).cause);
  // Without them, others' views may leave two poses that had one.
  if (const auto failure = leave_out_undecided(task, part, solved, parallel))
    throw NothingLeft(improved.findings, failure->cause);
  return true;
}

ImprovedPart improve_once(const PartTask& task, const Part& part, AdjustedPart solved,
                          const BetterCameras* known, Observations& observations, const ParallelFor& parallel,
                          const LogSink& log) {
  const Improvement improve = [&](const PartTask& by, AdjustedPart& improved, BetterCameras& found) {
    found = improve_cameras(by, part, parallel, log, improved);
  };
  const Improvement improve_again = [&](const PartTask& by, AdjustedPart& improved, BetterCameras& found) {
    improve_cameras_again(by, part, parallel, log, improved, found);
  };
  ImprovedPart result;
  result.solved = std::move(solved);
  if (known) {
    result.cameras.refined = known->refined;
    result.cameras.open = known->open;
  } else {
    improve_honestly(task, part, improve, observations, result.solved, result.cameras);
  }
  const std::vector<ViewCandidates>& by_cameras = result.cameras.candidates;
  const PartTask by_better{task.observations, by_cameras.empty() ? task.candidates : by_cameras,
                           task.options};
  if (leave_out_faulty(by_better, part, parallel, result) && !known)
    improve_honestly(task, part, improve_again, observations, result.solved, result.cameras);
  return result;
}

bool has_lens(const CameraRefinement& cameras) {
  return std::ranges::any_of(cameras.estimates,
                             [](const EstimatedParameter& one) { return one.parameter.is_of_lens(); });
}

/// A tag pulls no lens away by more than files of the same camera are off.
bool has_lens_near_file(const CameraRefinement& cameras) {
  return cameras.is_accepted && has_lens(cameras) && !is_far_from_file(cameras);
}

bool is_most_left(std::size_t left, std::size_t before) {
  return static_cast<double>(left) >= (1.0 - kMostInstead) * static_cast<double>(before);
}

/// By the file's lens: few tags and views had to go, and without them the views ask for no other.
bool is_explained_by_tags(const ImprovedPart& by_file, const Part& before) {
  const Part& left = by_file.solved.part;
  if (by_file.findings.empty() || left.tags.size() >= before.tags.size()) return false;
  if (!is_most_left(left.tags.size(), before.tags.size()) ||
      !is_most_left(left.views.size(), before.views.size()))
    return false;
  const BetterCameras& cameras = by_file.cameras;
  return !cameras.lens_not_taken && !(cameras.open && has_lens(*cameras.open));
}

/// The same with the lens that the file states, whichever tag is held by wish. nullopt where that does not
/// do, whatever tags are faulty.
std::optional<ImprovedPart> improved_by_file(const PartTask& task, const Part& part, AdjustedPart solved,
                                             Observations& observations, const ParallelFor& parallel,
                                             const LogSink& log) {
  CalibrationOptions options = task.options;
  options.intrinsics = Intrinsics::kKeep;
  options.held_tag.reset();
  const Part before = solved.part;
  try {
    ImprovedPart by_file = improve_once({task.observations, task.candidates, options}, part,
                                        std::move(solved), nullptr, observations, parallel, log);
    if (is_explained_by_tags(by_file, before)) return by_file;
  } catch (const Error&) {  // there is a map by the other lens
  }
  return std::nullopt;
}

void require_sound_held_tag(const PartTask& task, const ImprovedPart& improved) {
  for (const TagFinding& finding : improved.findings)
    if (finding.is_left_out && is_held_by_wish(task, finding.tag)) throw HeldTagAtFault(finding);
}

}  // namespace

ImprovedPart improve_part(const PartTask& task, const Part& part, AdjustedPart solved,
                          const BetterCameras* known, Observations& observations, const ParallelFor& parallel,
                          const LogSink& log) {
  if (known || task.options.intrinsics != Intrinsics::kAuto ||
      have_other_lenses(solved.state.cameras, task.observations.cameras))
    return improve_once(task, part, std::move(solved), known, observations, parallel, log);
  const int held_tag = solved.held_tag;
  AdjustedPart start = solved;
  std::vector<TagView> views = observations.views;
  ImprovedPart improved = improve_once(task, part, std::move(solved), nullptr, observations, parallel, log);
  if (!has_lens_near_file(improved.cameras.refined)) return improved;
  std::swap(observations.views, views);
  // A lens may stand for a tag of another size, and then holds nowhere else.
  auto by_file = improved_by_file(task, part, std::move(start), observations, parallel, log);
  if (by_file) require_sound_held_tag(task, *by_file);
  if (by_file && (by_file->solved.held_tag == held_tag || !is_held_by_wish(task, held_tag)))
    return std::move(*by_file);
  std::swap(observations.views, views);
  return improved;
}

}  // namespace apriltrack
