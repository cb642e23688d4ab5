#include "faults/split_tag.h"

#include <algorithm>

#include "apriltrack/base/error.h"

namespace apriltrack {

Observations split_tag(const Observations& observations, int tag, const std::vector<std::size_t>& views,
                       const std::vector<bool>& is_at_second) {
  const auto t = static_cast<std::size_t>(tag);
  Observations result = observations;
  const auto second = static_cast<int>(result.tags.size());
  result.tags.push_back(result.tags[t]);
  result.sizes_m.push_back(result.sizes_m[t]);
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (is_at_second[i]) result.views[views[i]].tag = second;
  }
  return result;
}

std::optional<AdjustedPart> solve_anew(const PartTask& task, const std::vector<std::size_t>& views, int tag,
                                       MirrorTests tests) {
  const std::vector<Part> parts = find_parts(task.observations, views, task.options.min_views).parts;
  if (parts.empty()) return std::nullopt;
  const auto held = std::ranges::find_if(parts.front().tags, [&](int one) { return one != tag; });
  Outcome<AdjustedPart> anew = adjust_part(task, parts.front(), *held, on_one_thread(task), tests);
  if (!anew) return std::nullopt;
  return std::move(*anew);
}

}  // namespace apriltrack
