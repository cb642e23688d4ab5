#include "improved_part.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "apriltrack/base/error.h"
#include "contradicted_tags.h"
#include "culprit_search.h"
#include "honest_edges.h"
#include "tag_examination.h"
#include "undecided_tags.h"

namespace apriltrack {
namespace {

// Of the tags that are mapped: where more had to go for the file's lens to do, it does not.
constexpr double kMostTagsInstead = 0.25;

/// Looks at each tag for faults, and leaves out what cannot be trusted. Whether that is any.
bool leave_out_faulty(const PartTask& task, const Part& part, const ParallelFor& parallel,
                      ImprovedPart& improved) {
  AdjustedPart& solved = improved.solved;
  const std::vector<int> tags_before = solved.part.tags;
  improved.findings = examine_tags(task, part, solved, parallel);
  improved.contradicted = leave_out_contradicted(task, part, solved);
  if (solved.part.tags == tags_before) return false;
  try {
    if (solved.contradictions.are_there()) fail_with_contradictions(task.observations, solved.contradictions);
    // Without them, others' views may leave two poses that had one.
    leave_out_undecided(task, part, solved, parallel);
  } catch (const Error& error) {
    fail_after(improved.findings, error);
  }
  return true;
}

ImprovedPart improve_once(const PartTask& task, const Part& part, AdjustedPart solved,
                          const CameraRefinement* estimated, Observations& observations,
                          const ParallelFor& parallel, const LogSink& log) {
  const Improvement improve = [&](const PartTask& by, AdjustedPart& improved, BetterCameras& found) {
    found = improve_cameras(by, part, parallel, log, improved);
  };
  const Improvement improve_again = [&](const PartTask& by, AdjustedPart& improved, BetterCameras& found) {
    improve_cameras_again(by, part, parallel, log, improved, found);
  };
  ImprovedPart result;
  result.solved = std::move(solved);
  if (estimated)
    result.cameras.refined = *estimated;
  else
    improve_honestly(task, part, improve, observations, result.solved, result.cameras);
  const std::vector<ViewCandidates>& by_cameras = result.cameras.candidates;
  const PartTask by_better{task.observations, by_cameras.empty() ? task.candidates : by_cameras,
                           task.options};
  if (leave_out_faulty(by_better, part, parallel, result) && !estimated)
    improve_honestly(task, part, improve_again, observations, result.solved, result.cameras);
  return result;
}

bool has_lens(const CameraRefinement& cameras) {
  return std::ranges::any_of(cameras.estimates,
                             [](const EstimatedParameter& one) { return one.parameter.is_of_lens(); });
}

/// A tag pulls no lens away by more than files of the same camera are off.
bool has_lens_near_file(const BetterCameras& cameras) {
  return cameras.refined.is_accepted && has_lens(cameras.refined) && cameras.candidates.empty();
}

/// By the file's lens, a few faulty tags are all that is wrong.
bool is_explained_by_tags(const ImprovedPart& by_file, std::size_t num_tags) {
  const double num_faulty = static_cast<double>(by_file.findings.size() + by_file.contradicted.size());
  if (by_file.findings.empty() || num_faulty > kMostTagsInstead * static_cast<double>(num_tags)) return false;
  const BetterCameras& cameras = by_file.cameras;
  return !cameras.lens_not_taken && !(cameras.open && has_lens(*cameras.open));
}

/// The same with the lens that the file states. nullopt where that does not do, whatever tags are faulty.
std::optional<ImprovedPart> improved_by_file(const PartTask& task, const Part& part, AdjustedPart solved,
                                             Observations& observations, const ParallelFor& parallel,
                                             const LogSink& log) {
  CalibrationOptions options = task.options;
  options.intrinsics = Intrinsics::kKeep;
  const std::size_t num_tags = solved.part.tags.size();
  try {
    ImprovedPart by_file = improve_once({task.observations, task.candidates, options}, part,
                                        std::move(solved), nullptr, observations, parallel, log);
    if (is_explained_by_tags(by_file, num_tags)) return by_file;
  } catch (const Error&) {  // there is a map by the other lens
  }
  return std::nullopt;
}

}  // namespace

ImprovedPart improve_part(const PartTask& task, const Part& part, AdjustedPart solved,
                          const CameraRefinement* estimated, Observations& observations,
                          const ParallelFor& parallel, const LogSink& log) {
  const bool may_lens_stand_for_tags = !estimated && task.options.intrinsics == Intrinsics::kAuto &&
                                       !have_other_lenses(solved.state.cameras, task.observations.cameras);
  const AdjustedPart start = solved;
  const std::vector<TagView> views = observations.views;
  ImprovedPart improved = improve_once(task, part, std::move(solved), estimated, observations, parallel, log);
  if (!may_lens_stand_for_tags || !has_lens_near_file(improved.cameras)) return improved;
  std::vector<TagView> views_by_lens = std::exchange(observations.views, views);
  // A lens may stand for a tag of another size, or a bent one, and then holds nowhere else.
  if (auto by_file = improved_by_file(task, part, start, observations, parallel, log)) return *by_file;
  observations.views = std::move(views_by_lens);
  return improved;
}

}  // namespace apriltrack
