#include "map_oddity_words.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace apriltrack::app {
namespace {

std::string sentence_of(const MapOddity& oddity) {
  const std::string first = to_string(oddity.tags.front());
  const std::size_t count = oddity.tags.size();
  switch (oddity.kind) {
    case MapOddityKind::kHugeTags:
      return fmt::format(
          "{} tags have edges of up to {:g} m (the first, {}): are they in another unit than metres?", count,
          oddity.value, first);
    case MapOddityKind::kOverlappingTags:
      return fmt::format(
          "{} and {} overlap, {:.4g} m from middle to middle: are places and sizes of one unit, metres?",
          first, to_string(oddity.tags.back()), oddity.value);
    case MapOddityKind::kOutsideField:
      return fmt::format(
          "{} tags lie outside the field that the file states, by up to {:.4g} m (the first, {}): are their "
          "places in "
          "another unit than metres?",
          count, oddity.value, first);
    case MapOddityKind::kFarApart:
      return fmt::format(
          "half of the tags are {:.4g} m and more from their nearest, over 1000 edges: are places in another "
          "unit than "
          "sizes?",
          oddity.value);
  }
  return "";
}

}  // namespace

void tell_oddities(const TagMap& map, const std::string& file, const Console& console) {
  for (const MapOddity& oddity : oddities_of(map)) console.warning(file + ": " + sentence_of(oddity));
}

nlohmann::json oddities_json(const TagMap& map) {
  nlohmann::json all = nlohmann::json::array();
  for (const MapOddity& oddity : oddities_of(map)) {
    nlohmann::json tags = nlohmann::json::array();
    for (const TagKey& key : oddity.tags) tags.push_back(to_string(key));
    all.push_back({{"kind", to_string(oddity.kind)}, {"tags", tags}, {"value_m", oddity.value}});
  }
  return all;
}

}  // namespace apriltrack::app
