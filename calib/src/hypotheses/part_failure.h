#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apriltrack/base/error.h"
#include "model/tag_finding.h"

namespace apriltrack {

// Why a part has no map, typed; messages/failure_message.h says it to the user.

inline constexpr std::string_view kTooLittleLeft = "what is left does not agree, or is too little";

/// The tag that the user holds would have to be left out.
class HeldTagAtFault : public Error {
 public:
  explicit HeldTagAtFault(TagFinding finding);
  /// Its views contradict all others, and no fault explains why.
  explicit HeldTagAtFault(int tag);

  int tag() const { return tag_; }
  const std::optional<TagFinding>& finding() const { return finding_; }

 private:
  int tag_;
  std::optional<TagFinding> finding_;
};

/// After the findings had left tags out, the others gave no map.
class NothingLeft : public Error {
 public:
  /// why: what then failed.
  NothingLeft(std::vector<TagFinding> findings, std::string_view why);

  const std::vector<TagFinding>& findings() const { return findings_; }
  const std::string& why() const { return why_; }

 private:
  std::vector<TagFinding> findings_;
  std::string why_;
};

}  // namespace apriltrack
