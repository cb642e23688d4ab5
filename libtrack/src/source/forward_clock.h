#pragma once

#include <fmt/format.h>

#include <optional>
#include <string>
#include <utility>

#include "apriltrack/base/timestamp.h"

namespace apriltrack {

/// Keeps a source's times running forward, whatever a file or a driver says of them.
class ForwardClock {
 public:
  /// Takes the next frame's time as told. Returns what is wrong with it, empty when nothing is; a frame whose
  /// time cannot be believed is put just after the one before.
  std::string take(std::optional<Timestamp> told) {
    const bool is_first = std::exchange(is_first_, false);
    const Timestamp before = time_;
    if (told && (is_first || *told > before)) {
      time_ = *told;
      return "";
    }
    if (!is_first) ++time_.ns;
    if (!told) return "it carries no time";
    return fmt::format("its time, {} s, is not later than the frame's before, {} s", format_seconds(*told),
                       format_seconds(before));
  }

  Timestamp time() const { return time_; }

 private:
  bool is_first_ = true;
  Timestamp time_;
};

}  // namespace apriltrack
