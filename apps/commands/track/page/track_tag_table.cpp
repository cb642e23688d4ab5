#include <fmt/format.h>

#include "track_report_tables.h"

namespace apriltrack::app {
namespace {

std::string count_or_blank(std::size_t count) {
  return count == 0 ? "-" : fmt::format("{}", count);
}

std::string time_of(const std::optional<Timestamp>& time, Timestamp start) {
  return time ? fmt::format("{:.3f}", seconds_between(start, *time)) : std::string("-");
}

std::vector<std::string> row_of(const TagKey& tag, const TagTally::Counts& counts, Timestamp start) {
  const auto residual_px = counts.median_residual_px();
  return {to_string(tag),
          count_or_blank(counts.of(SightStatus::kDetected)),
          count_or_blank(counts.of(SightStatus::kTracked)),
          count_or_blank(counts.of(SightStatus::kOccluded)),
          count_or_blank(counts.of(SightStatus::kHidden)),
          count_or_blank(counts.of(SightStatus::kElsewhere) + counts.of(SightStatus::kSuspect)),
          count_or_blank(counts.of(SightStatus::kUnjudged) + counts.of(SightStatus::kUnmapped)),
          residual_px ? fmt::format("{:.2f}", *residual_px) : std::string("-"),
          time_of(counts.first_used, start),
          time_of(counts.last_used, start)};
}

}  // namespace

HtmlTable tags_of_run_table(const TrackRecord& record, const TagMap& map) {
  HtmlTable table{{"tag", "detected", "tracked", "occluded", "hidden", "suspect", "of no use", "residual, px",
                   "first, s", "last, s"},
                  {},
                  "Frames in which each tag was what. Detected: read, and the pose rests on it; tracked: "
                  "through blur, by its "
                  "pixels; occluded: it should be seen and is not; hidden: not for some time; suspect: not "
                  "where the map has "
                  "it, of which even a few frames say that it was moved; of no use: read in a frame without "
                  "a pose of its "
                  "own, or not in the map. Residual: median distance of its corners, as read, from where the "
                  "pose puts them. "
                  "First and last: when a pose rested on it."};
  const Timestamp start = record.rows().front().timestamp;
  const auto& counts = record.tag_tally().counts();
  for (const MapTag& tag : map.tags) {
    const auto own = counts.find(tag.key);
    table.rows.push_back(row_of(tag.key, own == counts.end() ? TagTally::Counts{} : own->second, start));
  }
  for (const auto& [tag, of_tag] : counts)
    if (!map.find(tag)) table.rows.push_back(row_of(tag, of_tag, start));
  return table;
}

}  // namespace apriltrack::app
