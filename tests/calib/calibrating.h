#pragma once

#include <gmock/gmock.h>

#include <Eigen/Cholesky>
#include <algorithm>
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

/// Of a tag's pose against the truth in the frame of the held tag, by its covariance: chi squared of six
/// numbers where that is right.
inline double squared_sigmas_off(const SyntheticWorld& world, const TagKey& held, const MapTag& tag) {
  const Vector6d error = (tag.T_map_tag.inverse() * T_origin_tag(world.map, held, tag.key)).log();
  return error.dot(tag.covariance->ldlt().solve(error));
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

/// xi' covariance^-1 xi / 6 of every tag but the held one, relative to it; their mean.
inline double mean_normalised_error(const TagMap& truth, const TagKey& held, const TagMap& map,
                                    double* largest) {
  double sum = 0.0;
  *largest = 0.0;
  for (const MapTag& tag : map.tags) {
    if (tag.key == held) continue;
    const Vector6d xi = (tag.T_map_tag.inverse() * T_origin_tag(truth, held, tag.key)).log();
    const double error = xi.dot(tag.covariance->ldlt().solve(xi)) / 6.0;
    *largest = std::max(*largest, error);
    sum += error;
  }
  return sum / static_cast<double>(map.tags.size() - 1);
}

inline double mean_normalised_error(const SyntheticWorld& truth, const CalibrationResult& result) {
  double largest = 0.0;
  return mean_normalised_error(truth.map, result.held_tag, result.map, &largest);
}

/// Between the first tag and the last, 20 % too long.
inline MapConstraint false_distance(const SyntheticWorld& world) {
  const MapTag &a = world.map.tags.front(), &b = world.map.tags.back();
  const double distance_m = 1.2 * (a.T_map_tag.translation() - b.T_map_tag.translation()).norm();
  return {DistanceConstraint{a.key, b.key, distance_m, 0.001}};
}

}  // namespace apriltrack::test
