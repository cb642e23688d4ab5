#include "apriltrack/eval/combine_maps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "apriltrack/base/error.h"
#include "apriltrack/eval/compare_maps.h"
#include "held_tag.h"

namespace apriltrack {
namespace {

bool have_one_gauge(const TagMap& a, const TagMap& b) {
  const MapTag* held_a = find_held(a.tags, std::identity());
  const MapTag* held_b = find_held(b.tags, std::identity());
  return held_a && held_b && held_a->key == held_b->key;
}

void check_sizes(const MapComparison& comparison, const TagMap& base, const TagMap& addition) {
  for (const TagDifference& tag : comparison.tags) {
    if (std::abs(tag.size_difference_m) < 1e-9) continue;
    throw invalid_input("tag " + to_string(tag.key),
                        fmt::format("size: is {} m in one map and {} m in the other",
                                    base.find(tag.key)->size_m, addition.find(tag.key)->size_m));
  }
}

std::vector<MapConflict> find_conflicts(const MapComparison& comparison, const MergeOptions& options) {
  std::vector<MapConflict> conflicts;
  for (const TagDifference& tag : comparison.tags) {
    const bool is_conflict = tag.position_m > options.max_position_difference_m ||
                             tag.rotation_rad > options.max_rotation_difference_rad;
    if (is_conflict) conflicts.push_back({tag.key, tag.position_m, tag.rotation_rad});
  }
  return conflicts;
}

}  // namespace

void MergeOptions::check() const {
  if (!(max_position_difference_m >= 0.0))
    throw invalid_input("max_position_difference_m",
                        fmt::format("must be >= 0 (is {})", max_position_difference_m));
  if (!(max_rotation_difference_rad >= 0.0))
    throw invalid_input("max_rotation_difference_rad",
                        fmt::format("must be >= 0 (is {})", max_rotation_difference_rad));
}

AlignedMap align_map(const TagMap& reference, const TagMap& map) {
  MapComparison fit = compare_maps(reference, map);
  AlignedMap aligned{map, fit.T_truth_estimate, static_cast<int>(fit.tags.size()), std::move(fit)};
  aligned.map.frame = reference.frame;
  // A right perturbation lives in the tag's own frame: a motion of the world does not touch its covariance.
  for (MapTag& tag : aligned.map.tags) tag.T_map_tag = aligned.T_reference_map * tag.T_map_tag;
  return aligned;
}

MergedMap merge_maps(const TagMap& base, const TagMap& addition, const MergeOptions& options) {
  options.check();
  const MapComparison comparison = compare_maps(base, addition);
  check_sizes(comparison, base, addition);
  MergedMap merged{base,
                   comparison.T_truth_estimate,
                   static_cast<int>(comparison.tags.size()),
                   comparison.extra,
                   find_conflicts(comparison, options),
                   {}};
  const bool keeps_covariances = have_one_gauge(base, addition);
  for (const TagKey& key : comparison.extra) {
    MapTag tag = *addition.find(key);
    tag.T_map_tag = merged.T_base_addition * tag.T_map_tag;
    if (tag.covariance && !keeps_covariances) {
      tag.covariance.reset();
      merged.without_covariance.push_back(key);
    }
    merged.map.tags.push_back(std::move(tag));
  }
  return merged;
}

}  // namespace apriltrack
