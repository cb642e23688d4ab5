// What the tags that were read, and those of other families, tell.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "apriltrack/detect/chance_readings.h"
#include "apriltrack/detect/odd_picture_watch.h"
#include "apriltrack/eval/statistics.h"
#include "apriltrack/tags/tag_family.h"
#include "doctor_findings.h"

namespace apriltrack::app {
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
               const Finding& finding, std::vector<Finding>& findings) {
  std::vector<std::string> names;
  for (const TagSummary& tag : tags) {
    const std::string word = detail(tag);
    if (!word.empty()) names.push_back(fmt::format("{} ({})", to_string(tag.tag), word));
  }
  if (names.empty()) return;
  Finding told_of = finding;
  told_of.text = fmt::format(fmt::runtime(finding.text), told(names));
  findings.push_back(std::move(told_of));
}

void find_in_parts(std::span<const std::vector<TagKey>> parts, std::vector<Finding>& findings) {
  if (parts.front().size() < 2) {
    findings.push_back(
        {Severity::kStops, "none_together",
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
    if (part.size() > 1) groups.push_back("{" + told_part(part) + "}");
  if (groups.size() < 2) return;
  findings.push_back(
      {Severity::kWarning, "disconnected",
       fmt::format("the tags fall into {} groups that no frame joins: {}. calibrate maps one of them; film "
                   "frames that show a tag of each together, or map the groups with --parts",
                   groups.size(), fmt::join(groups, " | "))});
}

std::string num_places(std::size_t places) {
  return places == 1 ? "1 place" : fmt::format("{} places", places);
}

void find_in_links(std::span<const TagSummary> tags, std::vector<Finding>& findings) {
  find_tags(
      tags,
      [](const TagSummary& tag) {
        return tag.places_together < kLeastPlaces
                   ? fmt::format("{} in {} frame{}", num_places(tag.places_together), tag.frames,
                                 tag.frames == 1 ? "" : "s")
                   : std::string();
      },
      {Severity::kWarning, "left_out",
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
      {Severity::kWarning, "few_frames",
       "these tags are seen together with others from few places, so that their poses will be weak: {}. Film "
       "them longer and on the move, or use every frame"},
      findings);
}

void find_in_views(std::span<const TagSummary> tags, std::vector<Finding>& findings) {
  find_tags(
      tags,
      [](const TagSummary& tag) {
        return tag.frames_twice > 0 ? fmt::format("{} of {} frames", tag.frames_twice, tag.frames)
                                    : std::string();
      },
      {Severity::kWarning, "same_id_twice",
       "the same id is seen twice at once: {}. Were two tags printed with one id, or is there a picture of "
       "it? Take one away: ids must be unique"},
      findings);
  find_tags(
      tags,
      [](const TagSummary& tag) {
        return tag.median_edge_px < kSmall_px ? fmt::format("{:.0f} px", tag.median_edge_px) : std::string();
      },
      {Severity::kWarning, "small_tags",
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
      {Severity::kWarning, "only_at_border",
       "these tags are only seen at the image's border, where a lens model is least sure: {}. Bring them "
       "into the middle of the picture"},
      findings);
}

/// The same family's readings in all recordings, and frames looked at.
struct OtherFamily {
  std::size_t readings = 0;
  std::size_t sampled = 0;
};

std::map<std::string, OtherFamily> other_families(const Facts& facts) {
  std::map<std::string, OtherFamily> others;
  for (const RecordingFacts& recording : facts.recordings) {
    for (const FamilyReadings& readings : recording.other_families) {
      if (!is_surely_there(readings, recording.sampled)) continue;
      OtherFamily& other = others[readings.family];
      other.readings += readings.readings;
      other.sampled += recording.sampled;
    }
  }
  return others;
}

/// What was read as a family asked for, without a corrected bit, in all frames.
FamilyReadings asked_readings(const Facts& facts, const std::string& family) {
  FamilyReadings readings{.family = family};
  std::map<int, std::size_t> frames_of;
  std::vector<double> margins;
  for (const RecordingFacts& recording : facts.recordings) {
    for (const FrameFacts& frame : recording.frames) {
      for (const SeenTag& seen : frame.tags) {
        if (seen.tag.family != family || seen.corrected_bits > 0) continue;
        margins.push_back(seen.margin);
        readings.frames_of_one_tag = std::max(readings.frames_of_one_tag, ++frames_of[seen.tag.id]);
      }
    }
  }
  readings.readings = margins.size();
  if (!margins.empty()) readings.median_margin = median(margins);
  return readings;
}

/// Where a family asked for has so few bits that what was read as it may be no tags at all.
void find_chance(const Facts& facts, std::size_t frames, std::vector<Finding>& findings) {
  for (const std::string& family : facts.families) {
    const FamilyReadings readings = asked_readings(facts, family);
    if (readings.readings == 0 || is_surely_there(readings, frames)) continue;
    findings.push_back(
        {Severity::kWarning, "chance_readings",
         fmt::format(
             "the {} readings of {} may be chance: codes of so few bits are read into any pattern, and no "
             "tag of it comes back in a quarter of the frames with a clear margin; print a family of more "
             "bits, such as tag36h11, or ask for the one that is printed",
             readings.readings, family)});
  }
}

std::string told_family(const std::string& family, const OtherFamily& other) {
  return fmt::format("{} readings of {} in {} frames looked at{}", other.readings, family, other.sampled,
                     family == "tag36h11b2" ? " (the two-cell border of Kalibr's printed grids)" : "");
}

}  // namespace

bool is_surely_there(const FamilyReadings& readings, std::size_t sampled) {
  const double by_chance = chance_readings_per_frame(TagFamily::get(readings.family), 0);
  constexpr double kHardlyEver = 0.01;
  if (static_cast<double>(sampled) * by_chance < kHardlyEver) return readings.readings > 0;
  // Chance scatters over the ids, and what it reads has little contrast; a tag comes back.
  constexpr std::size_t kFewestFrames = 3;
  constexpr double kLeastMargin = 20.0;  // grey levels
  return readings.frames_of_one_tag >= std::max(kFewestFrames, sampled / 4) &&
         readings.median_margin >= kLeastMargin;
}

std::vector<Finding> find_in_families(const Facts& facts) {
  bool has_tags = false;
  std::size_t frames = 0;
  for (const RecordingFacts& recording : facts.recordings) {
    frames += recording.frames.size();
    for (const FrameFacts& frame : recording.frames) has_tags = has_tags || !frame.tags.empty();
  }
  std::vector<std::string> there, words;
  for (const auto& [family, other] : other_families(facts)) {
    there.push_back(told_family(family, other));
    words.push_back("--family " + family);
  }
  const std::string asked = fmt::format("{}", fmt::join(facts.families, ", "));
  std::vector<Finding> findings;
  find_chance(facts, frames, findings);
  if (has_tags && there.empty()) return findings;
  if (has_tags) {
    findings.push_back({Severity::kWarning, "other_family",
                        fmt::format("besides {} there are {}: if these tags are meant, give {}", asked,
                                    fmt::join(there, ", "), fmt::join(words, " "))});
    return findings;
  }
  if (!there.empty())
    return {{Severity::kStops, "other_family",
             fmt::format("no {}, but {}: use {}", asked, fmt::join(there, ", "), fmt::join(words, " "))}};
  const bool tried = std::ranges::any_of(facts.recordings, [](const auto& one) { return one.sampled > 0; });
  return {
      {Severity::kStops, "no_tags",
       fmt::format("no tag of {} in {} frames{}; tags must be sharp, with their white margin, and some 20 "
                   "px wide or more",
                   asked, frames, tried ? ", nor of any other family" : " (is another --family printed?)")}};
}

std::vector<Finding> find_in_odd_pictures(const RecordingFacts& recording,
                                          std::span<const std::string> families) {
  std::vector<Finding> findings;
  if (const auto& odd = recording.odd_pictures)
    findings.push_back({recording.are_some_good ? Severity::kWarning : Severity::kStops,
                        odd->are_mirrored && odd->are_inverted ? "mirrored_and_inverted"
                        : odd->are_mirrored                    ? "mirrored"
                                                               : "inverted",
                        message_of(*odd, families, !recording.are_some_good)});
  if (!recording.left_out.is_empty())
    findings.push_back({Severity::kNote, "readings_left_out", recording.left_out.message()});
  return findings;
}

namespace {

/// Frames of the camera file's size show no tags, others do.
bool are_tags_in_unusable_frames_alone(const Facts& facts) {
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

std::vector<Finding> find_in_places(const Facts& facts) {
  if (are_tags_in_unusable_frames_alone(facts))
    return {
        {Severity::kStops, "camera_resolution",
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
    return {{Severity::kStops, "one_place",
             seen + ": a map needs tags together from two places at least. Take more pictures, from several "
                    "sides"}};
  }
  if (facts.at_rest <= joint) return {};
  return {{Severity::kWarning, "at_rest",
           fmt::format("{} of {} pictures of two tags or more show what an earlier one shows, to a pixel: "
                       "however long the camera stands, a place counts once. Go on moving, slowly, and film "
                       "from more places",
                       facts.at_rest, facts.at_rest + joint)}};
}

std::vector<Finding> find_in_tags(std::span<const TagSummary> tags,
                                  std::span<const std::vector<TagKey>> parts) {
  std::vector<Finding> findings;
  if (tags.empty() || parts.empty()) return findings;
  find_in_parts(parts, findings);
  const bool stops = !findings.empty() && findings.front().severity == Severity::kStops;
  const bool has_places =
      std::ranges::any_of(tags, [](const TagSummary& tag) { return tag.places_together >= kLeastPlaces; });
  if (!stops && has_places) find_in_links(tags, findings);
  find_in_views(tags, findings);
  return findings;
}

}  // namespace apriltrack::app
