#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <set>

#include "apriltrack/base/error.h"
#include "apriltrack/tags/tag_family.h"
#include "apriltrack/tags/tag_map.h"
#include "family_source.h"
#include "tag_faults.h"

namespace apriltrack {
namespace {

std::string described(const Pose& pose) {
  const Eigen::Vector3d& p = pose.translation();
  const Eigen::Quaterniond& q = pose.rotation();
  return fmt::format("position {} {} {}, orientation {} {} {} {}", p.x(), p.y(), p.z(), q.x(), q.y(), q.z(),
                     q.w());
}

std::optional<std::string> fault_of_pose(const Pose& pose) {
  // A quaternion of zeros stays one when it is normalised.
  if (pose.is_finite() && pose.rotation().norm() > 0.5) return std::nullopt;
  return fmt::format("must be finite, with a rotation (is {})", described(pose));
}

std::optional<std::string> fault_of_statistics(const TagStatistics& statistics) {
  if (statistics.views < 0) return fmt::format("views must be >= 0 (is {})", statistics.views);
  if (std::isfinite(statistics.residual_rms_px) && statistics.residual_rms_px >= 0.0) return std::nullopt;
  return fmt::format("residual_rms_px must be finite and >= 0 (is {})", statistics.residual_rms_px);
}

/// The name of the first member that is wrong, and what is wrong with it.
std::optional<std::string> fault_of_tag(const MapTag& tag) {
  if (!TagFamily::is_known(tag.key.family)) return "family: " + unknown_family_message(tag.key.family);
  if (const auto fault = fault_of_id(tag.key)) return "id: " + *fault;
  if (const auto fault = fault_of_size(tag.size_m)) return "size_m: " + *fault;
  if (const auto fault = fault_of_pose(tag.T_map_tag)) return "T_map_tag: " + *fault;
  for (const double position_m : tag.T_map_tag.translation()) {
    if (const auto fault = fault_of_coordinate(position_m)) return "T_map_tag: position: " + *fault;
  }
  if (tag.covariance) {
    if (const auto fault = fault_of_covariance(*tag.covariance)) return "covariance: " + *fault;
  }
  if (tag.statistics) {
    if (const auto fault = fault_of_statistics(*tag.statistics)) return "statistics: " + *fault;
  }
  return std::nullopt;
}

}  // namespace

void check_tag_map(const TagMap& map, std::string_view where) {
  if (map.tags.empty()) throw invalid_input(where, "has no tags: a map needs at least one");
  if (!TagFamily::is_known(map.default_family))
    throw invalid_input(where, "default_family: " + unknown_family_message(map.default_family));
  std::set<TagKey> keys;
  for (const MapTag& tag : map.tags) {
    const std::string name = to_string(tag.key);
    if (const auto fault = fault_of_tag(tag))
      throw invalid_input(where, fmt::format("tag {}: {}", name, *fault));
    if (!keys.insert(tag.key).second) throw invalid_input(where, fmt::format("tag {} is in it twice", name));
  }
}

}  // namespace apriltrack
