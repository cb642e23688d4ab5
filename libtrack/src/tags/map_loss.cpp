#include "apriltrack/tags/map_loss.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <utility>

namespace apriltrack {
namespace {

constexpr std::array<std::string_view, 12> kKindNames = {
    "sizes",      "families",     "covariance", "tags",       "frame_name", "origin",
    "field_size", "matrix_order", "provenance", "statistics", "extensions", "foreign_keys"};
constexpr std::array<std::string_view, 5> kHowNames = {"left_out", "assumed", "given", "converted",
                                                       "unknown"};

std::string extensions_of(const TagMap& map, std::string_view own_extension) {
  std::vector<std::string> names;
  const auto take = [&](const std::vector<std::pair<std::string, std::string>>& extensions) {
    for (const auto& [name, text] : extensions) {
      if (name != own_extension && std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
  };
  take(map.extensions);
  for (const MapTag& tag : map.tags) take(tag.extensions);
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

std::string_view to_string(MapLossKind kind) {
  return kKindNames.at(static_cast<std::size_t>(kind));
}

std::string_view to_string(MapLossHow how) {
  return kHowNames.at(static_cast<std::size_t>(how));
}

void add_left_out(const TagMap& map, MapHoldings holdings, std::vector<MapLoss>& losses,
                  std::string_view own_extension) {
  const auto left_out = [&](MapLossKind kind, const std::string& value = "") {
    losses.push_back({.kind = kind, .value = value});
  };
  if (!holdings.sizes) left_out(MapLossKind::kSizes);
  if (!holdings.families) {
    std::vector<std::string> families;
    for (const MapTag& tag : map.tags) {
      if (std::ranges::find(families, tag.key.family) == families.end()) families.push_back(tag.key.family);
    }
    left_out(MapLossKind::kFamilies, fmt::format("{}", fmt::join(families, ", ")));
  }
  const auto has_covariance = [](const MapTag& tag) { return tag.covariance.has_value(); };
  if (!holdings.covariances && std::ranges::any_of(map.tags, has_covariance))
    left_out(MapLossKind::kCovariance);
  if (!holdings.frame_name) left_out(MapLossKind::kFrameName, map.frame);
  if (!map.provenance.empty()) left_out(MapLossKind::kProvenance);
  const auto has_statistics = [](const MapTag& tag) { return tag.statistics.has_value(); };
  if (std::ranges::any_of(map.tags, has_statistics)) left_out(MapLossKind::kStatistics);
  if (const std::string names = extensions_of(map, own_extension); !names.empty())
    left_out(MapLossKind::kExtensions, names);
}

}  // namespace apriltrack
