#include "tags_csv.h"

#include <fmt/format.h>

#include <iterator>
#include <string>

namespace apriltrack::app {
namespace {

std::string header() {
  std::string text =
      "timestamp_ns,family,id,status,is_read,log_odds,expected_share,found_share,shift_px,residual_px,sigma_"
      "px";
  for (int corner = 0; corner < 4; ++corner) text += fmt::format(",projected_c{0}x,projected_c{0}y", corner);
  return text + "\n";
}

std::string field(const std::optional<double>& value) {
  return value ? fmt::format(",{:.6g}", *value) : ",";
}

std::string corner_fields(const std::optional<std::array<Eigen::Vector2d, 4>>& corners_px) {
  if (!corners_px) return std::string(8, ',');
  std::string text;
  for (const Eigen::Vector2d& corner : *corners_px)
    text += fmt::format(",{:.4f},{:.4f}", corner.x(), corner.y());
  return text;
}

}  // namespace

TagsCsv::TagsCsv(StagedFiles& files, const std::filesystem::path& path) : file_(files, path) {
  file_.write(header());
}

void TagsCsv::add(Timestamp timestamp, std::span<const TagSight> sights) {
  std::string text;
  for (const TagSight& sight : sights) {
    fmt::format_to(std::back_inserter(text), "{},{},{},{},{}", timestamp.ns, sight.tag.family, sight.tag.id,
                   to_string(sight.status), sight.is_read ? 1 : 0);
    for (const auto& value : {sight.log_odds, sight.expected_share, sight.found_share, sight.shift_px,
                              sight.residual_px, sight.sigma_px})
      text += field(value);
    text += corner_fields(sight.projected_px) + "\n";
  }
  file_.write(text);
}

}  // namespace apriltrack::app
