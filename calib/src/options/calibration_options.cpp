#include "apriltrack/calib/calibration_options.h"

#include <fmt/format.h>

#include <string>
#include <string_view>

#include "apriltrack/base/error.h"
#include "apriltrack/calib/map_constraints.h"

namespace apriltrack {

void CalibrationOptions::check() const {
  const auto require = [](bool is_right, std::string_view name, const std::string& value,
                          std::string_view range) {
    if (!is_right) throw invalid_input(name, fmt::format("must be {} (is {})", range, value));
  };
  require(corner_sigma_px > 0.0 && corner_sigma_px <= 100.0, "corner_sigma_px",
          fmt::format("{}", corner_sigma_px), "in (0, 100]");
  require(edge_end_correlation > -1.0 && edge_end_correlation < 1.0, "edge_end_correlation",
          fmt::format("{}", edge_end_correlation), "in (-1, 1)");
  require(corner_bias_px >= 0.0 && corner_bias_px <= 100.0, "corner_bias_px",
          fmt::format("{}", corner_bias_px), "in [0, 100]");
  require(edge_offset_sigma_px >= 0.0 && edge_offset_sigma_px <= 100.0, "edge_offset_sigma_px",
          fmt::format("{}", edge_offset_sigma_px), "in [0, 100]");
  require(same_place_px >= 0.0 && same_place_px <= 100.0, "same_place_px", fmt::format("{}", same_place_px),
          "in [0, 100]");
  require(max_tags_with_covariance >= 0, "max_tags_with_covariance", std::to_string(max_tags_with_covariance),
          "0 or more");
  for (const MapConstraint& constraint : constraints) check_constraint(constraint);
  require(max_tags_with_joint_covariance >= 0, "max_tags_with_joint_covariance",
          std::to_string(max_tags_with_joint_covariance), "0 or more");
  require(min_views >= 1, "min_views", std::to_string(min_views), "1 or more");
  require(max_iterations >= 1, "max_iterations", std::to_string(max_iterations), "1 or more");
  require(num_threads >= 0, "num_threads", std::to_string(num_threads), "0 (all cores) or more");
}

}  // namespace apriltrack
