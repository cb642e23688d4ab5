#include "hypotheses/part_failure.h"

#include <utility>

namespace apriltrack {

HeldTagAtFault::HeldTagAtFault(TagFinding finding)
    : Error(no_result("calibrate", "the held tag is at fault")),
      tag_(finding.tag),
      finding_(std::move(finding)) {}

HeldTagAtFault::HeldTagAtFault(int tag)
    : Error(no_result("calibrate", "the held tag contradicts all others")), tag_(tag) {}

NothingLeft::NothingLeft(std::vector<TagFinding> findings, std::string_view why)
    : Error(no_result("calibrate", why)), findings_(std::move(findings)), why_(why) {}

}  // namespace apriltrack
