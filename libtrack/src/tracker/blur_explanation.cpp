#include "blur_explanation.h"

#include <algorithm>

#include "first_explanations.h"
#include "look_alikes.h"
#include "overruled_motion.h"
#include "path_variation.h"
#include "pulling_tags.h"
#include "unexplained_tags.h"
#include "wide_search.h"

namespace apriltrack {

std::vector<Explanation> BlurExplainer::explain(const BlurFrame& frame,
                                                const std::vector<MotionHypothesis>& hypotheses) const {
  std::vector<Explanation> found = explain_all(frame, hypotheses);
  if (found.empty()) return found;
  const std::vector<TagEvidence> unexplained = unexplained_at_start(found.front());
  if (unexplained.empty()) return found;
  const TagsPutAside aside(start_fit_.world(), unexplained);
  std::vector<Explanation> without = explain_all(frame, hypotheses);
  if (without.empty() || !is_same_place(start_fit_.world(), found.front(), without.front())) return found;
  for (Explanation& explanation : without) add_unexplained(unexplained, explanation);
  return without;
}

std::vector<Explanation> BlurExplainer::explain_all(const BlurFrame& frame,
                                                    const std::vector<MotionHypothesis>& hypotheses) const {
  std::vector<Explanation> found = explain_by_motion(start_fit_, frame, hypotheses);
  const bool has_asked_corners = found.empty() || !is_settled(frame, found.front());
  if (has_asked_corners) add_detected(start_fit_, frame, hypotheses, found);
  if (found.empty()) return found;
  if (!is_well_explained(found.front()) || found.front().prior_cost > kMaxExpectedPriorCost)
    vary_velocity(start_fit_, frame, found);
  vary_length(start_fit_, frame, found);
  search_widely(start_fit_, frame, hypotheses, found);
  explain_tags_that_pull(start_fit_, frame, found);
  start_over_where_overruled(start_fit_, frame, found);
  add_mirrored_tilt(start_fit_, frame, has_asked_corners, found);
  add_reversed_path(start_fit_, frame, found);
  return found;
}

}  // namespace apriltrack
