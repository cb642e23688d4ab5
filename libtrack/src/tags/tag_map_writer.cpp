#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>

#include "apriltrack/io/atomic_file.h"
#include "apriltrack/io/numbers.h"
#include "own_map.h"

namespace apriltrack {
namespace {

constexpr std::string_view kHeader =
    "# Tag map. Lengths in metres. pose: T_map_tag, tag coordinates to map coordinates; tag frame: origin "
    "at\n"
    "# the centre, x right, y down, z into the tag. size: edge of the square whose corners the detector "
    "reports\n"
    "# (tag36h11: outer edge of the black border). covariance: 6x6 row by row, [translation; rotation] of "
    "the\n"
    "# right perturbation of the pose, m and rad, relative to the map's gauge.\n";

/// Plain where no reader can take it for anything but a text, else in double quotes.
std::string yaml_text(const std::string& text) {
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  const auto is_plain = [&](char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '_'; };
  // Words that some YAML reader takes for a truth value or for nothing, whatever their case.
  static const std::set<std::string> kReserved = {"true", "false", "yes", "no",  "on",
                                                  "off",  "y",     "n",   "null"};
  std::string lower = text;
  std::ranges::transform(lower, lower.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  if (!text.empty() && is_letter(text[0]) && std::ranges::all_of(text, is_plain) &&
      !kReserved.contains(lower))
    return text;
  std::string quoted = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      quoted += {'\\', c};
    } else if (byte < 0x20 || byte == 0x7F) {
      quoted += fmt::format("\\x{:02X}", byte);
    } else {
      quoted += c;
    }
  }
  return quoted + '"';
}

void write_covariance(std::string& out, const Matrix6d& covariance) {
  out += "    covariance: [";
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) {
      if (column > 0) out += ", ";
      out += format_exact(covariance(row, column));
    }
    out += row < 5 ? ",\n                 " : "]\n";
  }
}

void write_statistics(std::string& out, const TagStatistics& statistics) {
  std::vector<std::string> flags;
  std::ranges::transform(statistics.flags, std::back_inserter(flags), yaml_text);
  out += fmt::format("    statistics: {{views: {}, residual_rms_px: {}, flags: [{}]}}\n", statistics.views,
                     format_exact(statistics.residual_rms_px), fmt::join(flags, ", "));
}

void write_tag(std::string& out, const MapTag& tag, const std::string& default_family) {
  const Eigen::Vector3d& p = tag.T_map_tag.translation();
  const Eigen::Quaterniond& q = tag.T_map_tag.rotation();
  out += fmt::format("  - id: {}\n", tag.key.id);
  if (tag.key.family != default_family) out += fmt::format("    family: {}\n", yaml_text(tag.key.family));
  out += fmt::format("    size: {}\n    pose:\n", format_exact(tag.size_m));
  out += fmt::format("      position: {{x: {}, y: {}, z: {}}}\n", format_exact(p.x()), format_exact(p.y()),
                     format_exact(p.z()));
  out += fmt::format("      orientation: {{x: {}, y: {}, z: {}, w: {}}}\n", format_exact(q.x()),
                     format_exact(q.y()), format_exact(q.z()), format_exact(q.w()));
  if (tag.covariance) write_covariance(out, *tag.covariance);
  if (tag.statistics) write_statistics(out, *tag.statistics);
  for (const auto& [key, text] : tag.extensions) out += fmt::format("    {}: {}\n", key, text);
}

}  // namespace

std::string own_map_text(const TagMap& map) {
  std::string out(kHeader);
  out += fmt::format("apriltrack_map: 1\nframe: {}\ndefault_family: {}\n", yaml_text(map.frame),
                     yaml_text(map.default_family));
  if (!map.provenance.empty()) out += "provenance:\n";
  for (const auto& [key, value] : map.provenance)
    out += fmt::format("  {}: {}\n", yaml_text(key), yaml_text(value));
  for (const auto& [key, text] : map.extensions) out += fmt::format("{}: {}\n", key, text);
  out += "tags:\n";
  for (const MapTag& tag : map.tags) write_tag(out, tag, map.default_family);
  return out;
}

void write_tag_map(const std::filesystem::path& path, const TagMap& map) {
  check_tag_map(map, path.string());  // what could not be read again must not be written
  write_file_atomically(path, own_map_text(map));
}

}  // namespace apriltrack
