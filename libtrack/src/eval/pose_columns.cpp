#include "pose_columns.h"

#include <fmt/format.h>

#include "apriltrack/base/error.h"
#include "apriltrack/geometry/rounded_rotation.h"

namespace apriltrack {
namespace {

// Files with two decimals are off by 0.01 at most; more than this is another column order or no quaternion.
constexpr double kMaxQuaternionLengthError = 0.05;

}  // namespace

Pose pose_of_columns(const std::array<double, kPoseColumns.size()>& values, const std::string& where) {
  const auto& [tx, ty, tz, qx, qy, qz, qw] = values;
  const Eigen::Quaterniond rotation(qw, qx, qy, qz);
  if (!is_rounded_rotation(rotation, kMaxQuaternionLengthError)) {
    throw invalid_input(
        where, fmt::format("qx qy qz qw: length of the quaternion must be 1 (is {:.4g})", rotation.norm()));
  }
  return {rotation, Eigen::Vector3d(tx, ty, tz)};
}

}  // namespace apriltrack
