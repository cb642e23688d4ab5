#pragma once

#include <cstddef>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <set>
#include <span>
#include <string>

#include "apriltrack/detect/detector.h"

namespace apriltrack::app {

/// Tags that were read and left out, over a run.
class LeftOutTags {
 public:
  void add(std::span<const LeftOutTag> tags);
  void add(const LeftOutTags& others);

  bool is_empty() const { return by_reason_.empty(); }
  /// "3 readings (tag36h11/8) were left out because ...; ..." for people; empty where there are none.
  std::string told() const;
  /// The same as a further sentence of a message: "; 3 readings ...", or empty.
  std::string told_after() const;
  /// A list of {reason, readings, tags} (docs/file_formats.md).
  nlohmann::json json() const;

 private:
  struct Readings {
    std::size_t count = 0;
    std::set<TagKey> tags;
  };
  std::map<LeftOutReason, Readings> by_reason_;
};

}  // namespace apriltrack::app
