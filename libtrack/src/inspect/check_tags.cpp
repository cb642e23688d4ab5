// What the tags that were read tell.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>

#include "checks.h"

namespace apriltrack {
namespace {

constexpr std::size_t kFewPlaces = 5;    ///< A tag seen from fewer is weakly placed.
constexpr std::size_t kLeastPlaces = 2;  ///< As calibrate's --min-views.
constexpr double kSmall_px = 20.0;       ///< Edges; smaller tags are read seldom and tilt freely.

/// At most eight by name.
std::string told(const std::vector<std::string>& names) {
  constexpr std::size_t kMostNamed = 8;
  if (names.size() <= kMostNamed) return fmt::format("{}", fmt::join(names, ", "));
  const auto end = names.begin() + kMostNamed;
  return fmt::format("{} and {} more", fmt::join(names.begin(), end, ", "), names.size() - kMostNamed);
}

std::string told_part(const std::vector<TagKey>& part) {
  std::vector<std::string> names;
  for (const TagKey& tag : part) names.push_back(to_string(tag));
  return told(names);
}

/// Adds a finding that names the tags for which `detail` has a word, if there are any. text: of them, {}
/// stands for their names.
void find_tags(std::span<const TagSummary> tags, const std::function<std::string(const TagSummary&)>& detail,
               const RecordingFinding& finding, std::vector<RecordingFinding>& findings) {
  std::vector<std::string> names;
  for (const TagSummary& tag : tags) {
    const std::string word = detail(tag);
    if (!word.empty()) names.push_back(fmt::format("{} ({})", to_string(tag.tag), word));
  }
  if (names.empty()) return;
  RecordingFinding told_of = finding;
  told_of.text = fmt::format(fmt::runtime(finding.text), told(names));
  findings.push_back(std::move(told_of));
}

void check_parts(std::span<const std::vector<TagKey>> parts, std::vector<RecordingFinding>& findings) {
  if (parts.front().size() < 2) {
    findings.push_back(
        {FindingSeverity::kStops, "none_together",
         parts.size() == 1
             ? fmt::format("only one tag was seen, {}: a map needs two or more, in view together",
                           to_string(parts.front().front()))
             : fmt::format("no two tags are ever in view together ({} seen): film from farther away, so that "
                           "frames show two or more",
                           parts.size())});
    return;
  }
  std::vector<std::string> groups;
  for (const std::vector<TagKey>& part : parts)
    if (part.size() > 1) groups.push_back(fmt::format("{{{}}}", told_part(part)));
  if (groups.size() < 2) return;
  findings.push_back(
      {FindingSeverity::kWarning, "disconnected",
       fmt::format("the tags fall into {} groups that no frame joins: {}. calibrate maps one of them; film "
                   "frames that show a tag of each together, or map the groups with --parts",
                   groups.size(), fmt::join(groups, " | "))});
}

std::string num_places(std::size_t places) {
  return places == 1 ? "1 place" : fmt::format("{} places", places);
}

void check_links(std::span<const TagSummary> tags, std::vector<RecordingFinding>& findings) {
  find_tags(
      tags,
      [](const TagSummary& tag) {
        return tag.places_together < kLeastPlaces
                   ? fmt::format("{} in {} frame{}", num_places(tag.places_together), tag.frames,
                                 tag.frames == 1 ? "" : "s")
                   : std::string();
      },
      {FindingSeverity::kWarning, "left_out",
       "calibrate leaves out tags that are seen together with another from fewer than two places: {}. Film "
       "each with a neighbour in view, from several sides; an id that is not there at all was read by "
       "chance"},
      findings);
  find_tags(
      tags,
      [](const TagSummary& tag) {
        return tag.places_together >= kLeastPlaces && tag.places_together < kFewPlaces
                   ? num_places(tag.places_together)
                   : std::string();
      },
      {FindingSeverity::kWarning, "few_frames",
       "these tags are seen together with others from few places, so that their poses will be weak: {}. Film "
       "them longer and on the move, or use every frame"},
      findings);
}

void check_views(std::span<const TagSummary> tags, std::vector<RecordingFinding>& findings) {
  find_tags(
      tags,
      [](const TagSummary& tag) {
        return tag.frames_twice > 0 ? fmt::format("{} of {} frames", tag.frames_twice, tag.frames)
                                    : std::string();
      },
      {FindingSeverity::kWarning, "same_id_twice",
       "the same id is seen twice at once: {}. Were two tags printed with one id, or is there a picture of "
       "it? Take one away: ids must be unique"},
      findings);
  find_tags(
      tags,
      [](const TagSummary& tag) {
        return tag.median_edge_px < kSmall_px ? fmt::format("{:.0f} px", tag.median_edge_px) : std::string();
      },
      {FindingSeverity::kWarning, "small_tags",
       "these tags are mostly less than 20 px wide, so that their tilt is hardly seen: {}. Go nearer, or "
       "print them larger"},
      findings);
  find_tags(
      tags,
      [](const TagSummary& tag) {
        return tag.views >= kFewPlaces && tag.views_at_border == tag.views
                   ? fmt::format("{} views", tag.views)
                   : std::string();
      },
      {FindingSeverity::kWarning, "only_at_border",
       "these tags are only seen at the image's border, where a lens model is least sure: {}. Bring them "
       "into the middle of the picture"},
      findings);
}

}  // namespace

namespace {

/// Frames of the camera file's size show no tags, others do.
bool are_tags_in_unusable_frames_alone(const InspectionFacts& facts) {
  bool some_are_usable = false, has_tags = false;
  for (const RecordingFacts& recording : facts.recordings) {
    for (const FrameFacts& frame : recording.frames) {
      some_are_usable = some_are_usable || is_usable(frame, recording.camera);
      has_tags = has_tags || !frame.tags.empty();
    }
  }
  return facts.places.empty() && some_are_usable && has_tags;
}

}  // namespace

std::vector<RecordingFinding> check_viewpoints(const InspectionFacts& facts) {
  if (are_tags_in_unusable_frames_alone(facts))
    return {
        {FindingSeverity::kStops, "camera_resolution",
         "tags are seen only in images of another size than the camera file's, which calibrate leaves out: "
         "give the camera file of these images"}};
  const auto joint = static_cast<std::size_t>(
      std::ranges::count_if(facts.places, [](const auto& tags) { return tags.size() > 1; }));
  if (joint == 1) {
    const std::string seen =
        facts.at_rest == 0
            ? "only one picture shows two tags or more"
            : fmt::format(
                  "all {} pictures of two tags or more are from one place (the camera stood still, or "
                  "frames were copied)",
                  facts.at_rest + 1);
    return {{FindingSeverity::kStops, "one_place",
             seen + ": a map needs tags together from two places at least. Take more pictures, from several "
                    "sides"}};
  }
  if (facts.at_rest <= joint) return {};
  return {{FindingSeverity::kWarning, "at_rest",
           fmt::format("{} of {} pictures of two tags or more show what an earlier one shows, to a pixel: "
                       "however long the camera stands, a place counts once. Go on moving, slowly, and film "
                       "from more places",
                       facts.at_rest, facts.at_rest + joint)}};
}

std::vector<RecordingFinding> check_tags(std::span<const TagSummary> tags,
                                         std::span<const std::vector<TagKey>> parts) {
  std::vector<RecordingFinding> findings;
  if (tags.empty() || parts.empty()) return findings;
  check_parts(parts, findings);
  const bool stops = !findings.empty() && findings.front().severity == FindingSeverity::kStops;
  const bool has_places =
      std::ranges::any_of(tags, [](const TagSummary& tag) { return tag.places_together >= kLeastPlaces; });
  if (!stops && has_places) check_links(tags, findings);
  check_views(tags, findings);
  return findings;
}

}  // namespace apriltrack
