#pragma once

#include <gmock/gmock.h>

#include <functional>
#include <string>
#include <vector>

#include "apriltrack/base/error.h"
#include "apriltrack/calib/calibrate_map.h"
#include "support/pose_matchers.h"
#include "synthetic_world.h"

namespace apriltrack::test {

inline constexpr double kExact_m = 1e-6;  // what rounding leaves of noise-free corners
inline constexpr double kExact_rad = 1e-6;

inline CalibrationResult calibrate(const SyntheticWorld& world, const std::vector<FrameDetections>& frames,
                                   const CalibrationOptions& options = {}) {
  return calibrate_map(frames, world.rig, world.sizes(), options);
}

/// Every tag of the result against the truth in the frame of the held tag.
inline void expect_truth(const SyntheticWorld& world, const TagMap& map, const TagKey& held,
                         double max_error_m, double max_error_rad) {
  for (const MapTag& tag : map.tags)
    EXPECT_THAT(tag.T_map_tag, PoseNear(T_origin_tag(world.map, held, tag.key), max_error_m, max_error_rad))
        << to_string(tag.key);
}

inline std::string error_of(ErrorKind kind, const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(static_cast<int>(error.kind()), static_cast<int>(kind)) << error.what();
    return error.what();
  }
  ADD_FAILURE() << "no error was thrown";
  return "";
}

inline TagKey tag36h11(int id) {
  return {"tag36h11", id};
}

}  // namespace apriltrack::test
