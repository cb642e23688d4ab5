#include "model/adjusted_part.h"

namespace apriltrack {

std::set<int> tags_left_out(const AdjustedPart& solved) {
  std::set<int> tags(solved.undecided.begin(), solved.undecided.end());
  for (const TagFinding& finding : solved.findings)
    if (finding.is_left_out) tags.insert(finding.tag);
  return tags;
}

}  // namespace apriltrack
