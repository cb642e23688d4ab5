#include "constraints/constraint_tags.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <string>

#include "apriltrack/base/error.h"
#include "observations/observations.h"

namespace apriltrack {
namespace {

/// Every TagKey of a constraint, to be changed.
std::vector<TagKey*> tag_slots(MapConstraint& constraint) {
  if (auto* distance = std::get_if<DistanceConstraint>(&constraint.what)) return {&distance->a, &distance->b};
  if (auto* board = std::get_if<RelativePoseConstraint>(&constraint.what)) return {&board->a, &board->b};
  if (auto* group = std::get_if<CoplanarConstraint>(&constraint.what)) {
    std::vector<TagKey*> slots;
    for (TagKey& tag : group->tags) slots.push_back(&tag);
    return slots;
  }
  if (auto* position = std::get_if<PositionConstraint>(&constraint.what)) return {&position->tag};
  if (auto* upright = std::get_if<UprightConstraint>(&constraint.what)) return {&upright->tag};
  if (auto* floor = std::get_if<FloorConstraint>(&constraint.what)) return {&floor->tag};
  if (auto* gravity = std::get_if<GravityConstraint>(&constraint.what)) return {&gravity->tag};
  return {};
}

}  // namespace

std::vector<MapConstraint> with_families(const std::vector<MapConstraint>& constraints,
                                         std::span<const TagKey> seen, std::span<const TagKey> left_out) {
  std::set<TagKey> known(seen.begin(), seen.end());
  known.insert(left_out.begin(), left_out.end());
  std::vector<MapConstraint> result = constraints;
  for (MapConstraint& constraint : result) {
    const std::string where = constraint.where.empty() ? "constraint" : constraint.where;
    const std::string title = title_of(constraint);
    for (TagKey* tag : tag_slots(constraint)) {
      std::vector<TagKey> meant;
      std::ranges::copy_if(known, std::back_inserter(meant), [&](const TagKey& key) {
        return key.id == tag->id && (tag->family.empty() || tag->family == key.family);
      });
      const std::string name = tag->family.empty() ? fmt::format("tag {}", tag->id) : to_string(*tag);
      if (meant.empty())
        throw invalid_input(where, fmt::format("{}: {} was never seen; seen were: {}", title, name,
                                               list_tags(std::vector<TagKey>(known.begin(), known.end()))));
      if (meant.size() > 1)
        throw invalid_input(where, fmt::format("{}: {} was seen of several families ({}); write family/ID",
                                               title, name, list_tags(meant)));
      *tag = meant.front();
    }
    check_constraint(constraint);                          // 7 and tag36h11/7 are one tag
    if (constraint.name.empty()) constraint.name = title;  // as it was written
  }
  return result;
}

}  // namespace apriltrack
