#include "tag_tally.h"

#include <nlohmann/json.hpp>

namespace apriltrack::app {
namespace {

nlohmann::json time_json(const std::optional<Timestamp>& time) {
  return time ? nlohmann::json(time->ns) : nlohmann::json(nullptr);
}

}  // namespace

void TagTally::add(Timestamp timestamp, std::span<const TagSight> sights) {
  for (const TagSight& sight : sights) {
    Counts& counts = counts_[sight.tag];
    ++counts.frames[static_cast<std::size_t>(sight.status)];
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
                          {"last_used_timestamp_ns", time_json(counts.last_used)}};
    for (const SightStatus status : sight_statuses()) one[to_string(status)] = counts.of(status);
    all.push_back(one);
  }
  return all;
}

}  // namespace apriltrack::app
