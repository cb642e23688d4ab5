#include "apriltrack/detect/left_out_tags.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

namespace apriltrack {
namespace {

const char* sentence_of(LeftOutReason reason) {
  switch (reason) {
    case LeftOutReason::kEdgesNotFitted:
      return "because the edges could not be fitted: the tag is too small or blurred, or hidden, or cut by "
             "the "
             "image";
    case LeftOutReason::kMayBeChance:
      return "because they may be chance: codes of so few bits are read into any pattern, and the picture "
             "does "
             "not look like the tag";
  }
  return "";
}

std::string names_of_left_out(const std::set<TagKey>& tags) {
  constexpr std::size_t kMostNamed = 8;
  std::vector<std::string> names;
  for (const TagKey& tag : tags)
    if (names.size() < kMostNamed) names.push_back(to_string(tag));
  const std::string more =
      tags.size() > kMostNamed ? fmt::format(" and {} more", tags.size() - kMostNamed) : "";
  return fmt::format("{}{}", fmt::join(names, ", "), more);
}

}  // namespace

void LeftOutTags::add(std::span<const LeftOutTag> tags) {
  for (const LeftOutTag& tag : tags) {
    Readings& readings = by_reason_[tag.reason];
    ++readings.count;
    readings.tags.insert(tag.reading.tag);
  }
}

void LeftOutTags::add(const LeftOutTags& others) {
  for (const auto& [reason, readings] : others.by_reason_) {
    by_reason_[reason].count += readings.count;
    by_reason_[reason].tags.insert(readings.tags.begin(), readings.tags.end());
  }
}

std::string LeftOutTags::message() const {
  std::vector<std::string> sentences;
  for (const auto& [reason, readings] : by_reason_)
    sentences.push_back(fmt::format(
        "{} ({}) {} left out {}",
        readings.count == 1 ? "1 reading of a tag" : fmt::format("{} readings of tags", readings.count),
        names_of_left_out(readings.tags), readings.count == 1 ? "was" : "were", sentence_of(reason)));
  return fmt::format("{}", fmt::join(sentences, "; "));
}

}  // namespace apriltrack
