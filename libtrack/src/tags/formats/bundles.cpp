#include "bundles.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "apriltrack/base/error.h"

namespace apriltrack {

TagBundle chosen_bundle(const std::vector<TagBundle>& bundles, const MapReadOptions& options,
                        const std::string& file, const std::string& word,
                        std::vector<ConversionLoss>& losses) {
  std::vector<std::string> names;
  for (const TagBundle& bundle : bundles) names.push_back(bundle.name);
  const auto found = std::ranges::find(names, options.bundle);
  const bool is_named = !options.bundle.empty();
  if (is_named && found == names.end())
    throw invalid_input(file, fmt::format("has no {} '{}' (--bundle); it has: {}", word, options.bundle,
                                          fmt::join(names, ", ")));
  if (!is_named && bundles.size() > 1)
    throw invalid_input(file,
                        fmt::format("has several {0}s, which are maps of their own: choose one by --bundle; "
                                    "it has: {1}",
                                    word, fmt::join(names, ", ")));
  const std::size_t chosen = is_named ? static_cast<std::size_t>(found - names.begin()) : 0;
  names.erase(names.begin() + static_cast<long>(chosen));
  if (!names.empty())
    losses.push_back({.kind = LossKind::kTags, .value = fmt::format("{}", fmt::join(names, ", "))});
  return bundles[chosen];
}

}  // namespace apriltrack
