#include "apriltrack/inspect/tag_summary.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "apriltrack/base/disjoint_sets.h"
#include "apriltrack/eval/statistics.h"

namespace apriltrack {
namespace {

/// Values of one tag, over all of its views.
struct TagViews {
  TagSummary summary;
  std::vector<double> edges_px, margins, blurs_px;

  void add(const SeenTag& seen) {
    ++summary.views;
    summary.views_at_border += seen.is_at_border;
    edges_px.push_back(seen.edge_px);
    margins.push_back(seen.margin);
    if (seen.blur_px) blurs_px.push_back(*seen.blur_px);
  }

  TagSummary summarised() const {
    TagSummary all = summary;
    all.median_edge_px = median(edges_px);
    all.smallest_edge_px = *std::ranges::min_element(edges_px);
    all.largest_edge_px = *std::ranges::max_element(edges_px);
    all.median_margin = median(margins);
    if (!blurs_px.empty()) all.median_blur_px = median(blurs_px);
    return all;
  }
};

}  // namespace

std::vector<TagSummary> summarise_tags(const InspectionFacts& facts) {
  std::map<TagKey, TagViews> tags;
  for (const RecordingFacts& recording : facts.recordings) {
    for (const FrameFacts& frame : recording.frames) {
      if (!is_usable(frame, recording.camera)) continue;
      std::map<TagKey, int> times;
      for (const SeenTag& seen : frame.tags) {
        tags[seen.tag].add(seen);
        ++times[seen.tag];
      }
      for (const auto& [tag, count] : times) {
        ++tags[tag].summary.frames;
        tags[tag].summary.frames_twice += count > 1;
      }
    }
  }
  for (const std::vector<TagKey>& place : facts.places) {
    for (const TagKey& tag : place)
      if (const auto of = tags.find(tag); of != tags.end() && place.size() > 1)
        ++of->second.summary.places_together;
  }
  std::vector<TagSummary> summaries;
  for (const auto& [tag, views] : tags) {
    summaries.push_back(views.summarised());
    summaries.back().tag = tag;
  }
  return summaries;
}

std::vector<std::vector<TagKey>> joined_parts(std::span<const std::vector<TagKey>> places) {
  std::map<TagKey, std::size_t> numbers;
  for (const std::vector<TagKey>& place : places)
    for (const TagKey& tag : place) numbers.try_emplace(tag, numbers.size());
  DisjointSets joined(numbers.size());
  for (const std::vector<TagKey>& place : places)
    for (const TagKey& tag : place) joined.join(numbers.at(place.front()), numbers.at(tag));
  std::map<std::size_t, std::vector<TagKey>> sets;
  for (const auto& [tag, number] : numbers) sets[joined.find(number)].push_back(tag);
  std::vector<std::vector<TagKey>> parts;
  for (auto& [root, tags] : sets) parts.push_back(std::move(tags));
  std::ranges::sort(parts, [](const auto& a, const auto& b) {
    return a.size() != b.size() ? a.size() > b.size() : a.front() < b.front();
  });
  return parts;
}

}  // namespace apriltrack
