#include "apriltrack/tags/map_oddities.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "formats/formats.h"

namespace apriltrack {
namespace {

constexpr double kHugeTag_m = 2.0;          // the largest standard sheet, A0, is 1.2 m long
constexpr double kBesideField_m = 1.0;      // tags hang on the field's walls and on what stands in it
constexpr double kNearestInEdges = 1000.0;  // no picture shows two such tags so that either can be read

const Eigen::Vector3d& place_of(const MapTag& tag) {
  return tag.T_map_tag.translation();
}

std::optional<MapOddity> huge_tags(const TagMap& map) {
  MapOddity found{MapOddityKind::kHugeTags, {}, 0.0};
  for (const MapTag& tag : map.tags) {
    if (tag.size_m <= kHugeTag_m) continue;
    found.tags.push_back(tag.key);
    found.value = std::max(found.value, tag.size_m);
  }
  return found.tags.empty() ? std::nullopt : std::optional(found);
}

/// Whether the middle of one lies within the other's print. Not of a small tag within a large one
/// (tagCustom48h12 is made for that), nor of prints back to back.
bool overlap(const MapTag& a, const MapTag& b) {
  constexpr double kLikeSize = 0.5, kOnePlane = 0.05, kParallel = 0.98;
  const double larger_m = std::max(a.size_m, b.size_m);
  if (std::min(a.size_m, b.size_m) < kLikeSize * larger_m) return false;
  const Eigen::Vector3d apart = a.T_map_tag.inverse() * place_of(b);
  const Eigen::Vector3d normal =
      (a.T_map_tag.rotation().conjugate() * b.T_map_tag.rotation()) * Eigen::Vector3d::UnitZ();
  return apart.head<2>().cwiseAbs().maxCoeff() < 0.5 * larger_m &&
         std::abs(apart.z()) < kOnePlane * larger_m && normal.z() > kParallel;
}

/// By x, so that neighbours are found without looking at all pairs.
std::vector<const MapTag*> sorted_by_x(const TagMap& map) {
  std::vector<const MapTag*> tags;
  for (const MapTag& tag : map.tags) tags.push_back(&tag);
  std::ranges::stable_sort(tags, {}, [](const MapTag* tag) { return place_of(*tag).x(); });
  return tags;
}

std::optional<MapOddity> overlapping_tags(const std::vector<const MapTag*>& tags) {
  double largest_m = 0.0;
  for (const MapTag* tag : tags) largest_m = std::max(largest_m, tag->size_m);
  for (std::size_t i = 0; i < tags.size(); ++i) {
    for (std::size_t j = i + 1; j < tags.size(); ++j) {
      if (place_of(*tags[j]).x() - place_of(*tags[i]).x() > largest_m) break;
      if (overlap(*tags[i], *tags[j]))
        return MapOddity{MapOddityKind::kOverlappingTags,
                         {tags[i]->key, tags[j]->key},
                         (place_of(*tags[i]) - place_of(*tags[j])).norm()};
    }
  }
  return std::nullopt;
}

std::optional<MapOddity> tags_outside_field(const TagMap& map) {
  const std::optional<StatedField> field = stated_field(map);
  if (!field) return std::nullopt;
  const Eigen::Vector2d half(0.5 * field->size.length_m, 0.5 * field->size.width_m);
  MapOddity found{MapOddityKind::kOutsideField, {}, 0.0};
  for (const MapTag& tag : map.tags) {
    const double beyond_m = ((place_of(tag).head<2>() - field->centre_m).cwiseAbs() - half).maxCoeff();
    if (beyond_m <= kBesideField_m) continue;
    found.tags.push_back(tag.key);
    found.value = std::max(found.value, beyond_m);
  }
  return found.tags.empty() ? std::nullopt : std::optional(found);
}

double nearest_m(const std::vector<const MapTag*>& tags, std::size_t i) {
  double nearest = std::numeric_limits<double>::infinity();
  const auto is_passed = [&](std::size_t j) {
    nearest = std::min(nearest, (place_of(*tags[i]) - place_of(*tags[j])).norm());
    return std::abs(place_of(*tags[i]).x() - place_of(*tags[j]).x()) > nearest;
  };
  for (std::size_t j = i + 1; j < tags.size(); ++j)
    if (is_passed(j)) break;
  for (std::size_t j = i; j-- > 0;)
    if (is_passed(j)) break;
  return nearest;
}

std::optional<MapOddity> tags_far_apart(const std::vector<const MapTag*>& tags) {
  if (tags.size() < 2) return std::nullopt;
  MapOddity found{MapOddityKind::kFarApart, {}, 0.0};
  std::vector<double> distances_m;
  for (std::size_t i = 0; i < tags.size(); ++i) {
    distances_m.push_back(nearest_m(tags, i));
    if (distances_m.back() > kNearestInEdges * tags[i]->size_m) found.tags.push_back(tags[i]->key);
  }
  if (2 * found.tags.size() <= tags.size()) return std::nullopt;
  const auto middle = distances_m.begin() + std::ssize(distances_m) / 2;
  std::ranges::nth_element(distances_m, middle);
  found.value = *middle;
  return found;
}

}  // namespace

std::vector<MapOddity> oddities_of(const TagMap& map) {
  const std::vector<const MapTag*> tags = sorted_by_x(map);
  std::vector<MapOddity> all;
  for (const auto& oddity :
       {huge_tags(map), overlapping_tags(tags), tags_outside_field(map), tags_far_apart(tags)})
    if (oddity) all.push_back(*oddity);
  return all;
}

std::string_view to_string(MapOddityKind kind) {
  static constexpr std::array<std::string_view, 4> kNames = {"huge_tags", "overlapping_tags", "outside_field",
                                                             "far_apart"};
  return kNames.at(static_cast<std::size_t>(kind));
}

}  // namespace apriltrack
