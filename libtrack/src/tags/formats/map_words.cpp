#include "map_words.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>

#include "apriltrack/base/error.h"
#include "apriltrack/io/numbers.h"

namespace apriltrack {
std::string yaml_double(double value) {
  std::string text = format_exact(value);
  if (text.find('.') != std::string::npos) return text;
  const std::size_t exponent = text.find('e');
  return text.insert(exponent == std::string::npos ? text.size() : exponent, ".0");
}

std::string ros_name(const std::string& text) {
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  std::string name = text.empty() || !is_letter(text[0]) ? "_" : "";
  for (const char c : text) name += is_letter(c) || (c >= '0' && c <= '9') ? c : '_';
  return name;
}

void require_distinct_ids(const TagMap& map, MapFormat format, const std::string& file) {
  std::map<int, TagKey> first;
  for (const MapTag& tag : map.tags) {
    const auto [known, is_new] = first.emplace(tag.key.id, tag.key);
    if (!is_new)
      throw invalid_input(file,
                          fmt::format("{} and {} would be one tag, for a {} knows tags by their ids alone: "
                                      "take one of them out of the map",
                                      to_string(known->second), to_string(tag.key), info_of(format).title));
  }
}

}  // namespace apriltrack
