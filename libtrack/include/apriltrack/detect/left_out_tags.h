#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <span>
#include <string>

#include "apriltrack/detect/detector.h"

namespace apriltrack {

/// Counts the tags that a detector read and left out (FoundTags::left_out), over the images of a run.
class LeftOutTags {
 public:
  struct Readings {
    std::size_t count = 0;  ///< Of one image each; a tag may have several.
    std::set<TagKey> tags;
  };

  void add(std::span<const LeftOutTag> tags);
  void add(const LeftOutTags& others);

  bool is_empty() const { return by_reason_.empty(); }
  /// Only the reasons for which there are readings.
  const std::map<LeftOutReason, Readings>& by_reason() const { return by_reason_; }
  /// For people: "3 readings of tags (tag36h11/8) were left out because ...; ..."; empty where there are
  /// none.
  std::string message() const;

 private:
  std::map<LeftOutReason, Readings> by_reason_;
};

}  // namespace apriltrack
