#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "apriltrack/calib/assess_map.h"
#include "apriltrack/calib/calibration_result.h"
#include "apriltrack/detect/detection.h"
#include "apriltrack/tags/tag_map.h"
#include "observations/observations.h"

namespace apriltrack {
namespace {

/// In which a camera comes to what is near. Between takes, and after a pause, it may have been carried
/// anywhere.
constexpr double kSoon_s = 10.0;

using KeySet = std::set<TagKey>;
using Sighted = std::map<Timestamp, KeySet>;

Sighted sighted(std::span<const FrameDetections> frames) {
  Sighted by_time;
  for (const FrameDetections& frame : frames) {
    for (const Detection& detection : frame.detections) by_time[frame.timestamp].insert(detection.tag);
  }
  return by_time;
}

std::map<TagKey, int> count_frames(const Sighted& by_time) {
  std::map<TagKey, int> counts;
  for (const auto& [time, tags] : by_time) {
    for (const TagKey& tag : tags) ++counts[tag];
  }
  return counts;
}

/// Of those of `tags` that were seen then, the one that is seen most.
std::optional<TagKey> most_seen(const KeySet& seen, const KeySet& tags, const std::map<TagKey, int>& counts) {
  std::optional<TagKey> best;
  for (const TagKey& tag : seen) {
    if (tags.contains(tag) && (!best || counts.at(tag) > counts.at(*best))) best = tag;
  }
  return best;
}

/// The two that were seen closest after each other, if soon.
std::optional<JoinAdvice> closest(const Sighted& by_time, const std::map<TagKey, int>& counts,
                                  const KeySet& of_map, const KeySet& of_other) {
  std::optional<JoinAdvice> best;
  std::optional<std::pair<Timestamp, TagKey>> last_of_map, last_of_other;
  const auto consider = [&](const auto& map, const auto& other) {
    if (!map || !other) return;
    const double apart_s = std::abs(seconds_between(map->first, other->first));
    if (apart_s <= kSoon_s && (!best || apart_s < *best->apart_s))
      best = JoinAdvice{map->second, other->second, {}, apart_s, ""};
  };
  for (const auto& [time, seen] : by_time) {
    const auto now_of_map = most_seen(seen, of_map, counts);
    const auto now_of_other = most_seen(seen, of_other, counts);
    if (now_of_map) last_of_map.emplace(time, *now_of_map);
    if (now_of_other) last_of_other.emplace(time, *now_of_other);
    if (now_of_map || now_of_other) consider(last_of_map, last_of_other);
  }
  return best;
}

/// Where nothing tells which of them are near each other, those that are easiest to see.
std::optional<JoinAdvice> most_seen_of_each(const std::map<TagKey, int>& counts, const KeySet& of_map,
                                            const KeySet& of_other) {
  KeySet seen;
  for (const auto& [tag, count] : counts) seen.insert(tag);
  const auto map = most_seen(seen, of_map, counts), other = most_seen(seen, of_other, counts);
  if (!map || !other) return std::nullopt;
  return JoinAdvice{*map, *other, {}, std::nullopt, ""};
}

std::string reason_of(const JoinAdvice& advice) {
  if (!advice.apart_s)
    return fmt::format(
        "or any other two of the map and of these that are near each other: none were seen "
        "within {:g} s",
        kSoon_s);
  if (*advice.apart_s > 0.0)
    return fmt::format("they were seen {:.2g} s after each other, closer than any others", *advice.apart_s);
  return "one frame shows both, which is too little";
}

std::string words_of(const JoinAdvice& advice) {
  constexpr std::size_t kNamed = 6;
  return fmt::format("film {} and {} together, a few frames from two sides: that joins {} to the map ({})",
                     to_string(advice.of_map), to_string(advice.of_other), list_tags(advice.others, kNamed),
                     reason_of(advice));
}

KeySet keys_in(const TagMap& map) {
  KeySet keys;
  for (const MapTag& tag : map.tags) keys.insert(tag.key);
  return keys;
}

/// Tags in no map that no frame shows together with one of the map.
std::vector<KeySet> lone_tags(const CalibrationResult& result, const Sighted& by_time, const KeySet& of_map) {
  std::vector<KeySet> lone;
  for (const TagKey& tag : result.left_out) {
    const bool is_joined = std::ranges::any_of(by_time, [&](const auto& moment) {
      return moment.second.contains(tag) &&
             std::ranges::any_of(moment.second, [&](const TagKey& other) { return of_map.contains(other); });
    });
    if (!is_joined) lone.push_back({tag});
  }
  return lone;
}

}  // namespace

std::vector<JoinAdvice> advise_joining(const CalibrationResult& result,
                                       std::span<const FrameDetections> frames) {
  const Sighted by_time = sighted(frames);
  const std::map<TagKey, int> counts = count_frames(by_time);
  const KeySet of_map = keys_in(result.map);
  std::vector<KeySet> others;
  for (const TagMap& part : result.other_parts) others.push_back(keys_in(part));
  for (KeySet& tag : lone_tags(result, by_time, of_map)) others.push_back(std::move(tag));
  std::vector<JoinAdvice> advice;
  for (const KeySet& other : others) {
    auto one = closest(by_time, counts, of_map, other);
    if (!one) one = most_seen_of_each(counts, of_map, other);
    if (!one) continue;
    one->others.assign(other.begin(), other.end());
    one->words = words_of(*one);
    advice.push_back(std::move(*one));
  }
  return advice;
}

}  // namespace apriltrack
