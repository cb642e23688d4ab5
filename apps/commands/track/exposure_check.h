#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "apriltrack/base/timestamp.h"
#include "cli/console.h"

namespace apriltrack::app {

/// Holds the exposures that are told against the times of the frames: none can reach into the one before.
class ExposureCheck {
 public:
  explicit ExposureCheck(const Console& console) : console_(console) {}

  /// Frame by frame, in order; where: the file and key that tell the exposure. Throws Error(kInvalidInput)
  /// where the second frame's exposure is longer than the time since the first; of a later one it warns,
  /// once: a single time stamp may be wrong, and a long run is not to end.
  void add(Timestamp time, const std::optional<double>& exposure_s, std::string_view where);

 private:
  const Console& console_;
  std::optional<Timestamp> previous_;
  bool is_second_ = true;
  bool has_warned_ = false;
};

}  // namespace apriltrack::app
