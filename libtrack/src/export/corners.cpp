// Corners in millimetres, in our order, and named as whoever looks at the tag sees them.
#include <fmt/format.h>

#include <array>

#include "apriltrack/geometry/tag_corners.h"
#include "apriltrack/io/numbers.h"
#include "apriltrack/io/quoted_text.h"
#include "writers.h"

namespace apriltrack {
namespace {

constexpr std::array<std::string_view, kNumCorners> kCornerNames = {"bottom_left", "bottom_right",
                                                                    "top_right", "top_left"};

std::string in_mm(double length_m) {
  return format_exact(shift_decimal(length_m, 3));
}

std::string corners_of_tag_json(const MapTag& tag) {
  std::string text = fmt::format("    {{\"family\": {}, \"id\": {}, \"size_mm\": {}, \"corners_mm\": {{",
                                 quoted_text(tag.key.family), tag.key.id, in_mm(tag.size_m));
  const auto corners = corners_in_map(tag);
  for (std::size_t i = 0; i < corners.size(); ++i)
    text += fmt::format("{}\n      \"{}\": [{}, {}, {}]", i == 0 ? "" : ",", kCornerNames[i],
                        in_mm(corners[i].x()), in_mm(corners[i].y()), in_mm(corners[i].z()));
  return text + "}}";
}

}  // namespace

std::string corners_csv(const TagMap& map) {
  std::string out = "family,id,size_mm,corner,name,x_mm,y_mm,z_mm\n";
  for (const MapTag& tag : map.tags) {
    const auto corners = corners_in_map(tag);
    for (std::size_t i = 0; i < corners.size(); ++i)
      out +=
          fmt::format("{},{},{},{},{},{},{},{}\n", tag.key.family, tag.key.id, in_mm(tag.size_m), i,
                      kCornerNames[i], in_mm(corners[i].x()), in_mm(corners[i].y()), in_mm(corners[i].z()));
  }
  return out;
}

std::string corners_json(const TagMap& map) {
  std::string out = fmt::format(
      "{{\n  \"apriltrack_corners\": 1,\n  \"frame\": {},\n  \"unit\": \"mm\",\n  \"corner_order\": [",
      quoted_text(map.frame));
  for (std::size_t i = 0; i < kCornerNames.size(); ++i)
    out += fmt::format("{}\"{}\"", i == 0 ? "" : ", ", kCornerNames[i]);
  out += "],\n  \"tags\": [\n";
  for (std::size_t i = 0; i < map.tags.size(); ++i) {
    out += corners_of_tag_json(map.tags[i]);
    out += i + 1 < map.tags.size() ? ",\n" : "\n";
  }
  return out + "  ]\n}\n";
}

}  // namespace apriltrack
