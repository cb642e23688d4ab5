#include "hypotheses/improved_part.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "apriltrack/base/error.h"
#include "apriltrack/base/parallel.h"
#include "apriltrack/calib/calibration_options.h"
#include "faults/part_without.h"
#include "hypotheses/contradicted_tags.h"
#include "hypotheses/faulty_tags.h"
#include "hypotheses/honest_edges.h"
#include "hypotheses/part_failure.h"
#include "hypotheses/rivals.h"
#include "hypotheses/undecided_tags.h"
#include "initialise/part_adjustment.h"

namespace apriltrack {
namespace {

/// Looks at each tag for faults, and leaves out what cannot be trusted. Whether that is any.
bool leave_out_faulty(const PartTask& task, const Part& part, const ParallelFor& parallel,
                      ImprovedPart& improved) {
  AdjustedPart& solved = improved.solved;
  const std::vector<int> tags_before = solved.part.tags;
  leave_out_faulty_tags(task, part, {}, solved, parallel);
  leave_out_rivals(task, part, solved, parallel);  // or the map may be folded
  improved.contradicted = leave_out_contradicted(task, part, solved);
  solved.contradictions =
      contradictions_of(task, narrowed_to(task.observations, part, solved.part.tags), solved.state);
  if (solved.contradictions.are_there())
    throw NothingLeft(solved.findings, contradictory(task.observations, solved.contradictions).cause);
  if (solved.part.tags == tags_before) return false;
  // Without them, others' views may leave two poses that had one.
  if (const auto failure = leave_out_undecided(task, part, solved, parallel))
    throw NothingLeft(solved.findings, failure->cause);
  return true;
}

}  // namespace

ImprovedPart improve_part(const PartTask& task, const Part& part, AdjustedPart solved,
                          const BetterCameras* known, Observations& observations,
                          const ParallelFor& parallel) {
  ImprovedPart result;
  result.solved = std::move(solved);
  if (known) {
    result.cameras.refined = known->refined;
    result.cameras.open = known->open;
  } else {
    take_honest_edges(task, part, observations, result.solved);
    result.cameras = improve_cameras(task, part, parallel, result.solved);
  }
  const std::vector<ViewCandidates>& by_cameras = result.cameras.candidates;
  const PartTask by_better{task.observations, by_cameras.empty() ? task.candidates : by_cameras,
                           task.options};
  if (leave_out_faulty(by_better, part, parallel, result) && !known) {
    take_honest_edges(task, part, observations, result.solved);
    improve_cameras_again(task, part, parallel, result.solved, result.cameras);
  }
  return result;
}

}  // namespace apriltrack
