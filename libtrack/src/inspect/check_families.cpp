// What tags of the families asked for, and of others, tell.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>

#include "apriltrack/detect/odd_picture_watch.h"
#include "apriltrack/eval/statistics.h"
#include "apriltrack/inspect/recording_summary.h"
#include "checks.h"

namespace apriltrack {
namespace {

/// The same family's readings in all recordings, and frames looked at.
struct OtherFamily {
  std::size_t readings = 0;
  std::size_t sampled = 0;
};

std::map<std::string, OtherFamily> other_families(const InspectionFacts& facts) {
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
FamilyReadings asked_readings(const InspectionFacts& facts, const std::string& family) {
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
void find_chance(const InspectionFacts& facts, std::size_t frames, std::vector<RecordingFinding>& findings) {
  for (const std::string& family : facts.families) {
    const FamilyReadings readings = asked_readings(facts, family);
    if (readings.readings == 0 || is_surely_there(readings, frames)) continue;
    findings.push_back(
        {FindingSeverity::kWarning, "chance_readings",
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

std::vector<RecordingFinding> check_families(const InspectionFacts& facts) {
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
  std::vector<RecordingFinding> findings;
  find_chance(facts, frames, findings);
  if (has_tags && there.empty()) return findings;
  if (has_tags) {
    findings.push_back({FindingSeverity::kWarning, "other_family",
                        fmt::format("besides {} there are {}: if these tags are meant, give {}", asked,
                                    fmt::join(there, ", "), fmt::join(words, " "))});
    return findings;
  }
  if (!there.empty())
    return {{FindingSeverity::kStops, "other_family",
             fmt::format("no {}, but {}: use {}", asked, fmt::join(there, ", "), fmt::join(words, " "))}};
  const bool tried = std::ranges::any_of(facts.recordings, [](const auto& one) { return one.sampled > 0; });
  return {
      {FindingSeverity::kStops, "no_tags",
       fmt::format("no tag of {} in {} frames{}; tags must be sharp, with their white margin, and some 20 "
                   "px wide or more",
                   asked, frames, tried ? ", nor of any other family" : " (is another --family printed?)")}};
}

std::vector<RecordingFinding> check_odd_pictures(const RecordingFacts& recording,
                                                 std::span<const std::string> families) {
  std::vector<RecordingFinding> findings;
  if (const auto& odd = recording.odd_pictures)
    findings.push_back({recording.are_some_good ? FindingSeverity::kWarning : FindingSeverity::kStops,
                        odd->are_mirrored && odd->are_inverted ? "mirrored_and_inverted"
                        : odd->are_mirrored                    ? "mirrored"
                                                               : "inverted",
                        message_of(*odd, families, !recording.are_some_good)});
  if (!recording.left_out.is_empty())
    findings.push_back({FindingSeverity::kNote, "readings_left_out", recording.left_out.message()});
  return findings;
}

}  // namespace apriltrack
