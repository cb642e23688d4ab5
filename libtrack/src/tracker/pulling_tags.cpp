#include "pulling_tags.h"

namespace apriltrack {
namespace {

/// Fewer pull no other tag.
constexpr int kLeastPixels = 100;
/// Below, nothing of a tag is in its place; half of one behind a hand has more.
constexpr double kMaxCorrelation = 0.5;
/// In scores: what a tag's fit is worth is more by far.
constexpr double kBetter = 5.0;

std::vector<int> tags_that_may_pull(const Explanation& explanation) {
  std::vector<int> result;
  for (const TagEvidence& tag : explanation.fit.tags) {
    if (tag.num_pixels >= kLeastPixels && tag.clean_correlation() < kMaxCorrelation)
      result.push_back(tag.tag_index);
  }
  return result;
}

Explanation explained_from(const StartFit& start_fit, const BlurFrame& frame, const Explanation& start) {
  return start_fit.explained(frame, {start.fit.state, start.prior, start.is_cold}, {.coarsest_level = 1});
}

}  // namespace

void explain_tags_that_pull(const StartFit& start_fit, const BlurFrame& frame,
                            std::vector<Explanation>& found) {
  const Explanation& best = found.front();
  const std::vector<int> pulling = tags_that_may_pull(best);
  if (pulling.empty() || !best.is_explained()) return;
  PhotometricWorld& world = start_fit.world();
  for (const int index : pulling) world.tag_at(index).is_hidden = true;
  const Explanation without = explained_from(start_fit, frame, best);
  for (const int index : pulling) world.tag_at(index).is_hidden = false;
  Explanation all = explained_from(start_fit, frame, without);
  if (all.score < best.score + kBetter) return;
  found.push_back(std::move(all));
  sort_by_score(found);
}

}  // namespace apriltrack
