#include "lost_reason.h"

namespace apriltrack {

std::string lost_reason(const BlurFrame& frame, const std::vector<Explanation>& found) {
  if (frame.detections.empty()) return "no tag seen, and no recent pose to look from";
  if (frame.observations.empty() && count_tags(frame.read) == 1)
    return "the tag seen is not where the map has it, as others showed";
  if (frame.observations.empty() && !frame.read.empty()) return "the tags seen do not agree on a pose";
  if (frame.observations.empty()) return "no tag of the map seen, and no recent pose to look from";
  if (found.empty()) return "the corners seen fit no pose";
  const TagVotes& votes = found.front().votes;
  if (votes.agreeing.size() > votes.contradicting.size())
    return "a pose fits the corners, but not the pixels around them: exposure, or response?";
  return count_tags(frame.observations) > 1 ? "the tags seen do not agree on a pose"
                                            : "the corners seen fit no pose";
}

}  // namespace apriltrack
