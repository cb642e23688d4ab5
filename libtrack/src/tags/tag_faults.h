#pragma once

#include <optional>
#include <string>

#include "apriltrack/geometry/pose.h"
#include "apriltrack/tags/tag_key.h"

namespace apriltrack {

// What is wrong with a value, as the end of a sentence that begins with its name; nullopt when it is good.
// One rule for maps that are read and for maps that a program makes.

/// Metres: finite, > 0, and no number of millimetres.
std::optional<std::string> fault_of_size(double size_m);

/// One coordinate of a tag's place, in metres: finite, and of this Earth.
std::optional<std::string> fault_of_coordinate(double position_m);

/// Unit length, but for rounding to a few decimals.
std::optional<std::string> fault_of_quaternion(const Eigen::Quaterniond& rotation);

/// Requires a known family.
std::optional<std::string> fault_of_id(const TagKey& key);

/// Finite, symmetric, positive semidefinite; all but for rounding.
std::optional<std::string> fault_of_covariance(const Matrix6d& covariance);

}  // namespace apriltrack
