#include "wide_search.h"

#include <algorithm>
#include <cstdint>
#include <functional>

#include "blur_cloud.h"

namespace apriltrack {
namespace {

/// Explained so badly that a second, larger cloud may find what the first missed; later after the last
/// evidence than this the prior is too wide for any.
constexpr double kPoorCorrelation = 0.85;
constexpr double kMaxSecondCloudAge_s = 0.1;
constexpr std::uint64_t kMaxClouds = 2;
constexpr std::size_t kMaxFitted = 2;  // of a cloud's survivors
constexpr std::size_t kMaxBases = 2;   // of clouds: hypotheses, or cold starts

/// What the clouds are drawn about.
std::vector<MotionStart> bases_of_clouds(const std::vector<MotionHypothesis>& hypotheses,
                                         const std::vector<Explanation>& found) {
  std::vector<MotionStart> bases;
  for (const MotionHypothesis& hypothesis : hypotheses)
    bases.push_back({hypothesis.belief.mean, hypothesis, false});
  if (!hypotheses.empty()) return bases;
  for (const Explanation& explanation : found) {  // the best of each detection's
    if (!explanation.is_cold) continue;
    const MotionBelief& belief = explanation.prior.belief;
    const bool is_new = std::ranges::none_of(bases, [&](const MotionStart& base) {
      return base.state.pose.translation() == belief.mean.pose.translation();
    });
    if (is_new && bases.size() < kMaxBases) bases.push_back({belief.mean, explanation.prior, true});
  }
  return bases;
}

/// Where the survivors of a cloud lead, best first. cloud: 0, or 1 for the one after.
std::vector<Sketch> sketches_of_cloud(const StartFit& start_fit, const BlurFrame& frame,
                                      const std::vector<MotionStart>& bases, std::uint64_t cloud,
                                      const std::vector<Explanation>& found) {
  std::vector<MotionState> seeds;
  for (const Explanation& explanation : found) seeds.push_back(explanation.fit.state);
  std::vector<MotionBelief> beliefs;
  for (const MotionStart& base : bases) beliefs.push_back(base.prior.belief);
  const BlurTrackerOptions& of_tracker = start_fit.options();
  const CloudOptions options{static_cast<int>(1 + cloud) * of_tracker.num_particles, of_tracker.seed,
                             kMaxClouds * frame.index + cloud};
  std::vector<Sketch> sketches;
  for (const auto& [state, belief] :
       search_cloud(start_fit.world(), frame.photometric, beliefs, seeds, options)) {
    const MotionStart& base = bases[belief];
    sketches.push_back(start_fit.sketched(frame, {state, base.prior, base.is_cold}, 1));
  }
  std::ranges::stable_sort(sketches, std::greater(), &Sketch::score);
  return sketches;
}

}  // namespace

void search_widely(const StartFit& start_fit, const BlurFrame& frame,
                   const std::vector<MotionHypothesis>& hypotheses, std::vector<Explanation>& found) {
  const std::vector<MotionHypothesis> kNone;  // a cold start is best where the motion so far was mistaken
  const bool is_recent = frame.interval_s && *frame.interval_s <= kMaxSecondCloudAge_s;
  for (std::uint64_t cloud = 0; cloud < kMaxClouds; ++cloud) {
    const Explanation& best = found.front();
    if (is_well_explained(best)) return;
    if (cloud > 0 && !best.is_cold && (!is_recent || best.correlation >= kPoorCorrelation)) return;
    const std::vector<Sketch> sketches = sketches_of_cloud(
        start_fit, frame, bases_of_clouds(best.is_cold ? kNone : hypotheses, found), cloud, found);
    for (std::size_t i = 0; i < std::min(kMaxFitted, sketches.size()); ++i) {
      found.push_back(start_fit.explained(frame, sketches[i].start, {.coarsest_level = 0}));
      if (is_well_explained(found.back())) break;
    }
    sort_by_score(found);
  }
}

}  // namespace apriltrack
