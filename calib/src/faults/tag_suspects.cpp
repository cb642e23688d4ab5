#include "faults/tag_suspects.h"

#include <algorithm>
#include <map>
#include <utility>

#include "apriltrack/base/parallel.h"
#include "faults/part_without.h"

namespace apriltrack {
namespace {

constexpr double kSuspicious = 2.5;
constexpr double kManyRejectedOfSuspect = 1.0 / 3.0;  // of a tag's views

/// Tags of the map of which many views were rejected.
std::set<int> tags_rejected_often(const Observations& observations, const Part& part,
                                  const AdjustedPart& solved) {
  const std::map<int, int> offered =
      count_views(observations, narrowed_to(observations, part, solved.part.tags));
  std::set<int> tags;
  for (const auto& [tag, kept] : count_views(observations, solved.part)) {
    if (offered.at(tag) - kept > kManyRejectedOfSuspect * offered.at(tag)) tags.insert(tag);
  }
  return tags;
}

/// Of several views with the map.
struct Disagreement {
  double squares = 0.0;  ///< Of those that were kept.
  std::size_t kept = 0, rejected = 0;
  std::set<int> frames_of_rejected;

  double mean_square() const { return kept == 0 ? 0.0 : squares / static_cast<double>(kept); }
  double rejected_share() const {
    return static_cast<double>(rejected) / static_cast<double>(std::max<std::size_t>(kept + rejected, 1));
  }
};

}  // namespace

bool does_disturb(const PartTask& task, const Part& part, const AdjustedPart& solved, int tag) {
  constexpr double kFewRejectedShare = 0.03, kMuchMoreRejected = 2.0, kWorse = 1.3;
  constexpr std::size_t kEnough = 20;
  constexpr std::size_t kLeastFramesOfRejected = 3;  // a corner that is off, or covered, is soon over
  constexpr double kExpected = 8.0;  // of a view's squares, where others are too few to tell what is usual
  if (!std::ranges::binary_search(solved.part.tags, tag)) return true;
  std::set<int> frames_of_tag;
  const Part offered = narrowed_to(task.observations, part, solved.part.tags);
  for (const std::size_t v : offered.views)
    if (task.observations.views[v].tag == tag) frames_of_tag.insert(task.observations.views[v].frame);
  Disagreement beside, elsewhere;
  for (const std::size_t v : offered.views) {
    const TagView& view = task.observations.views[v];
    Disagreement& one = frames_of_tag.contains(view.frame) ? beside : elsewhere;
    if (!std::ranges::binary_search(solved.part.views, v)) {
      ++one.rejected;
      one.frames_of_rejected.insert(view.frame);
      continue;
    }
    ++one.kept;
    bool is_valid = false;
    one.squares += whitened_residual(task.observations, view, solved.state, is_valid).squaredNorm();
  }
  const double usual = elsewhere.kept < kEnough ? kExpected : elsewhere.mean_square();
  const double usual_share = std::max(kFewRejectedShare, kMuchMoreRejected * elsewhere.rejected_share());
  return (beside.frames_of_rejected.size() >= kLeastFramesOfRejected &&
          beside.rejected_share() > usual_share) ||
         beside.mean_square() > kWorse * usual;
}

TagLook look_by(const PartTask& task, const Part& part, const AdjustedPart& solved, int tag) {
  return look_at(task, solved, probe_views(task, part, solved, tag), tag);
}

std::vector<int> suspects_in(const PartTask& task, const Part& part, const AdjustedPart& solved,
                             const std::set<int>& known, const ParallelFor& parallel) {
  const std::set<int> rejected = tags_rejected_often(task.observations, part, solved);
  std::vector<TagLook> looks(part.tags.size());
  parallel(looks.size(), [&](std::size_t i) {
    if (!known.contains(part.tags[i])) looks[i] = look_by(task, part, solved, part.tags[i]);
  });
  std::vector<std::pair<double, int>> suspects;
  for (std::size_t i = 0; i < looks.size(); ++i) {
    const TagLook& look = looks[i];
    if (known.contains(part.tags[i])) continue;
    if (look.misfit > kSuspicious || look.finding || rejected.contains(part.tags[i]))
      suspects.emplace_back(-look.misfit, part.tags[i]);
  }
  std::ranges::sort(suspects);
  std::vector<int> tags;
  for (const auto& [misfit, tag] : suspects) tags.push_back(tag);
  return tags;
}

}  // namespace apriltrack
