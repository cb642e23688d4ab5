#pragma once

#include <optional>
#include <string>

#include "foreign_map.h"

namespace apriltrack {

/// The covariance that a pose of TagSLAM states, in our order, along the axes of the body or of TagSLAM's
/// tag; nullopt where it states none.
std::optional<Matrix6d> covariance_of_tagslam(const YamlNode& pose);

/// The same as lines for a file, each behind `indent`; nullopt of a covariance that has no inverse, such as
/// that of a tag that is held.
std::optional<std::string> text_of_tagslam_covariance(const Matrix6d& covariance, const std::string& indent);
/// Standard deviations alone, metres and radians, none below `least`.
std::string text_of_tagslam_sigmas(const Vector6d& sigmas, double least, const std::string& indent);

}  // namespace apriltrack
