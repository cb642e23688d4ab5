#include "pulling_tags.h"

#include <algorithm>
#include <utility>

#include "place_spread.h"

namespace apriltrack {
namespace {

/// Fewer pull no other tag.
constexpr int kLeastPixels = 100;
/// Below, nothing of a tag is in its place; half of one behind a hand has more. Noise and all: of what is dim
/// or blurred noise is much. A tag that has no part in the end may have pulled on the way there.
constexpr double kMaxCorrelation = 0.5;
/// In scores, beyond what two fits of one minimum differ by: a tag's fit is worth hundreds.
constexpr double kBetter = 5.0;
/// Of their centres in the image: tags that move less when they are left out did not pull.
constexpr double kPulled_px = 1.0;

std::vector<int> tags_that_may_pull(const Explanation& explanation) {
  std::vector<int> result;
  for (const TagEquations& tag : explanation.fit.equations) {
    if (tag.evidence.num_pixels >= kLeastPixels && tag.evidence.correlation < kMaxCorrelation)
      result.push_back(tag.evidence.tag_index);
  }
  return result;
}

bool has_moved(const PhotometricWorld& world, const std::vector<int>& tags, const Pose& from,
               const Pose& to) {
  return std::ranges::any_of(
      tags, [&](int index) { return !(place_shift_px(world, world.tag_at(index), from, to) < kPulled_px); });
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
  if (!has_moved(world, pulling, best.fit.state.pose, without.fit.state.pose)) return;
  Explanation all = explained_from(start_fit, frame, without);
  if (!(all.score >= best.score + kBetter)) return;
  found.front() = std::move(all);  // what was pulled is no second pose
  sort_by_score(found);
}

}  // namespace apriltrack
