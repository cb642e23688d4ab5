#include "tag_tally.h"

#include <nlohmann/json.hpp>

#include "apriltrack/eval/statistics.h"

namespace apriltrack::app {
namespace {

nlohmann::json time_json(const std::optional<Timestamp>& time) {
  return time ? nlohmann::json(time->ns) : nlohmann::json(nullptr);
}

}  // namespace

std::optional<double> TagTally::Counts::median_residual_px() const {
  if (residuals_px.empty()) return std::nullopt;
  return median(residuals_px);
}

void TagTally::add(Timestamp timestamp, std::span<const TagSight> sights) {
  for (const TagSight& sight : sights) {
    Counts& counts = counts_[sight.tag];
    ++counts.frames[static_cast<std::size_t>(sight.status)];
    if (sight.residual_px) counts.residuals_px.push_back(*sight.residual_px);
    const bool is_used = sight.status == SightStatus::kDetected || sight.status == SightStatus::kTracked;
    if (!is_used) continue;
    if (!counts.first_used) counts.first_used = timestamp;
    counts.last_used = timestamp;
  }
}

nlohmann::json TagTally::json() const {
  nlohmann::json all = nlohmann::json::array();
  for (const auto& [tag, counts] : counts_) {
    nlohmann::json one = {{"family", tag.family},
                          {"id", tag.id},
                          {"used", counts.used()},
                          {"first_used_timestamp_ns", time_json(counts.first_used)},
                          {"last_used_timestamp_ns", time_json(counts.last_used)},
                          {"median_residual_px", nullptr}};
    if (const auto residual_px = counts.median_residual_px()) one["median_residual_px"] = *residual_px;
    for (const SightStatus status : sight_statuses()) one[to_string(status)] = counts.of(status);
    all.push_back(one);
  }
  return all;
}

}  // namespace apriltrack::app
