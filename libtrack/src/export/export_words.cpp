#include "export_words.h"

#include <fmt/format.h>

#include <algorithm>

#include "apriltrack/io/numbers.h"

namespace apriltrack {

std::string exact_numbers(const Eigen::Vector3d& v) {
  return fmt::format("{} {} {}", format_exact(v.x()), format_exact(v.y()), format_exact(v.z()));
}

std::string exact_numbers(const Pose& pose) {
  const Eigen::Quaterniond& q = pose.rotation();
  return fmt::format("{} {} {} {} {}", exact_numbers(pose.translation()), format_exact(q.x()),
                     format_exact(q.y()), format_exact(q.z()), format_exact(q.w()));
}

std::string flat_name(const TagKey& key) {
  return fmt::format("{}_{}", key.family, key.id);
}

std::string plain_name(std::string_view text) {
  std::string name;
  for (const char c : text) {
    const bool is_plain =
        (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
    name += is_plain ? c : '_';
  }
  return name.empty() ? "map" : name;
}

std::string plain_frame_name(const TagMap& map) {
  std::string name = plain_name(map.frame);
  while (std::ranges::any_of(map.tags, [&](const MapTag& tag) { return flat_name(tag.key) == name; }))
    name += "_frame";
  return name;
}

}  // namespace apriltrack
