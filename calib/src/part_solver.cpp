#include "part_solver.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "apriltrack/base/error.h"
#include "corner_views.h"
#include "culprit_search.h"
#include "part_adjustment.h"
#include "scaled_covariance.h"

namespace apriltrack {
namespace {

constexpr double kNonsense_px = 5.0;

void measure_residuals(const Observations& observations, PartSolution& solution) {
  std::vector<double> sums(observations.tags.size(), 0.0);
  std::vector<int> counts(observations.tags.size(), 0);
  double total = 0.0;
  for (const std::size_t v : solution.part.views) {
    const TagView& view = observations.views[v];
    bool is_valid = false;
    Vector8d residual_px;
    whitened_residual(observations, view, solution.state, is_valid, &residual_px);
    sums[static_cast<std::size_t>(view.tag)] += residual_px.squaredNorm();
    counts[static_cast<std::size_t>(view.tag)] += 8;
    total += residual_px.squaredNorm();
  }
  for (const int tag : solution.part.tags) {
    const auto t = static_cast<std::size_t>(tag);
    solution.residual_rms_px.push_back(std::sqrt(sums[t] / std::max(counts[t], 1)));
  }
  solution.total_rms_px = std::sqrt(total / (8.0 * static_cast<double>(solution.part.views.size())));
}

void measure_covariances(const Observations& observations, const CalibrationOptions& options,
                         PartSolution& solution) {
  if (solution.part.tags.size() > static_cast<std::size_t>(options.max_tags_with_covariance)) return;
  const std::vector<LinearView> views = corner_views(observations, solution.part.views, solution.state);
  const double bias = options.corner_bias_px / options.corner_sigma_px;
  auto covariances = scaled_covariances(views, solution.part.tags, solution.held_tag, bias * bias);
  if (!covariances)
    throw no_result("calibrate",
                    "the views leave the pose of a tag undetermined; film each tag from more sides, together "
                    "with others");
  solution.covariances = std::move(*covariances);
}

}  // namespace

PartSolution solve_part(const Observations& observations, const Part& part, int held_tag,
                        const std::vector<ViewCandidates>& candidates, const CalibrationOptions& options,
                        const ParallelFor& parallel, const LogSink& log) {
  const PartTask task{observations, candidates, options};
  AdjustedPart solved = adjust_part(task, part, held_tag, parallel);
  if (solved.contradictions.are_there()) solved = adjust_without_culprit(task, part, solved, parallel, log);
  PartSolution solution;
  solution.held_tag = solved.held_tag;
  solution.culprit = solved.culprit;
  solution.part = std::move(solved.part);
  solution.state = std::move(solved.state);
  measure_residuals(observations, solution);
  measure_covariances(observations, options, solution);

  solution.views_offered = part.views.size();
  solution.views_offered_by_tag.assign(observations.tags.size(), 0);
  for (const std::size_t v : part.views)
    ++solution.views_offered_by_tag[static_cast<std::size_t>(observations.views[v].tag)];
  std::set_difference(part.tags.begin(), part.tags.end(), solution.part.tags.begin(),
                      solution.part.tags.end(), std::back_inserter(solution.lost_tags));
  if (solution.culprit) std::erase(solution.lost_tags, *solution.culprit);
  if (!(solution.total_rms_px < kNonsense_px))
    throw no_result(
        "calibrate",
        fmt::format("the adjusted map leaves errors of {:.1f} px: {}; corners from elsewhere must "
                    "come in the order bottom-left, bottom-right, top-right, top-left",
                    solution.total_rms_px, kWhatToCheck));
  return solution;
}

}  // namespace apriltrack
