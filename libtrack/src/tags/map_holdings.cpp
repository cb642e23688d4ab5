#include "apriltrack/tags/map_holdings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

namespace apriltrack {
namespace {

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

void add_left_out(const TagMap& map, MapHoldings holdings, std::vector<ConversionLoss>& losses,
                  std::string_view own_extension) {
  const auto left_out = [&](LossKind kind, const std::string& value = "") {
    losses.push_back({.kind = kind, .value = value});
  };
  if (!holdings.sizes) left_out(LossKind::kSizes);
  if (!holdings.families) {
    std::vector<std::string> families;
    for (const MapTag& tag : map.tags) {
      if (std::ranges::find(families, tag.key.family) == families.end()) families.push_back(tag.key.family);
    }
    left_out(LossKind::kFamilies, fmt::format("{}", fmt::join(families, ", ")));
  }
  const auto has_covariance = [](const MapTag& tag) { return tag.covariance.has_value(); };
  if (!holdings.covariances && std::ranges::any_of(map.tags, has_covariance)) left_out(LossKind::kCovariance);
  if (!holdings.frame_name) left_out(LossKind::kFrameName, map.frame);
  if (!map.provenance.empty()) left_out(LossKind::kProvenance);
  const auto has_statistics = [](const MapTag& tag) { return tag.statistics.has_value(); };
  if (std::ranges::any_of(map.tags, has_statistics)) left_out(LossKind::kStatistics);
  if (const std::string names = extensions_of(map, own_extension); !names.empty())
    left_out(LossKind::kExtensions, names);
}

}  // namespace apriltrack
