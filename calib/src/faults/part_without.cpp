#include "faults/part_without.h"

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include "apriltrack/base/parallel.h"
#include "apriltrack/calib/calibration_options.h"

namespace apriltrack {

bool is_held_by_wish(const PartTask& task, int tag) {
  return task.options.held_tag == task.observations.tags[static_cast<std::size_t>(tag)];
}

std::optional<HeldPart> part_without(const PartTask& task, const Part& part, const std::set<int>& gone,
                                     int held_tag) {
  const auto& [observations, candidates, options] = task;
  const std::vector<std::size_t> views = views_without(observations, part, gone);
  if (is_held_by_wish(task, held_tag)) {
    if (gone.contains(held_tag)) return std::nullopt;
    Part rest = connected_to(observations, views, held_tag, options.min_views);
    if (rest.tags.size() < 2) return std::nullopt;
    return HeldPart{std::move(rest), held_tag};
  }
  std::vector<Part> parts = find_parts(observations, views, options.min_views).parts;
  if (parts.empty()) return std::nullopt;
  Part& largest = parts.front();
  const bool is_held_there = std::ranges::binary_search(largest.tags, held_tag);
  const int held = is_held_there ? held_tag : largest.tags.front();
  return HeldPart{std::move(largest), held};
}

bool adjust_without(const PartTask& task, const Part& part, const std::set<int>& gone, AdjustedPart& solved) {
  const std::optional<HeldPart> rest = part_without(task, part, gone, solved.held_tag);
  if (!rest) return false;
  MapState state = solved.state;
  if (rest->held_tag != solved.held_tag) move_origin_to(state, rest->held_tag);
  Outcome<Part> kept = adjust_cleanly(task, rest->part, rest->held_tag, state);
  if (!kept) return false;
  solved.part = std::move(*kept);
  solved.state = std::move(state);
  solved.contradictions = contradictions_of(task, rest->part, solved.state);
  solved.held_tag = rest->held_tag;
  return true;
}

std::set<int> tags_out(const AdjustedPart& solved, const std::set<int>& tags, const std::set<int>& known) {
  std::set<int> out = tags;
  std::ranges::copy_if(known, std::inserter(out, out.end()),
                       [&](int one) { return !std::ranges::binary_search(solved.part.tags, one); });
  return out;
}

bool solve_without(const PartTask& task, const Part& part, const std::set<int>& gone, AdjustedPart& solved,
                   const ParallelFor& parallel) {
  CalibrationOptions options = task.options;
  if (std::ranges::any_of(gone, [&](int tag) { return is_held_by_wish(task, tag); }))
    options.held_tag.reset();
  Observations by_cameras = task.observations;
  by_cameras.cameras = solved.state.cameras;
  const PartTask without{by_cameras, task.candidates, options};
  const std::optional<HeldPart> rest = part_without(without, part, gone, solved.held_tag);
  if (!rest) return false;
  Outcome<AdjustedPart> anew = adjust_part(without, rest->part, rest->held_tag, parallel);
  if (!anew) return false;
  solved.held_tag = rest->held_tag;
  solved.part = std::move(anew->part);
  solved.state = std::move(anew->state);
  solved.contradictions = std::move(anew->contradictions);
  return true;
}

}  // namespace apriltrack
