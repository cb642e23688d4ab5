// RTAB-Map's Marker/Priors: "id x y z roll pitch yaw|id ...", metres and radians, also with x y z qx qy qz qw
// or the 12 numbers of a 3x4 matrix (Parameters.h, Rtabmap.cpp and Transform.cpp of introlab/rtabmap;
// rotations Rz Ry Rx). Read from the string itself, from one marker a line, and from an .ini with
// Marker\Priors, whose Marker\Length, Marker\Dictionary and Marker\PriorsVariance... are used. The tag's
// frame is that of OpenCV's aruco module, by which MarkerDetector.cpp there detects.
#include "rtabmap.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <sstream>

#include "../tag_faults.h"
#include "apriltrack/base/error.h"
#include "apriltrack/geometry/rotation.h"
#include "apriltrack/io/numbers.h"
#include "foreign_map.h"
#include "map_words.h"

namespace apriltrack {
namespace {

/// DICT_APRILTAG_... of OpenCV.
constexpr std::array<std::pair<int, std::string_view>, 4> kRtabmapDictionaries = {
    {{17, "tag16h5"}, {18, "tag25h9"}, {19, "tag36h10"}, {20, "tag36h11"}}};
constexpr std::string_view kBlank = " \t\r\"'";

struct RtabmapValue {
  std::string text;
  std::size_t line = 1;
};

std::string_view without_blanks(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlank);
  return begin == std::string_view::npos ? "" : text.substr(begin, text.find_last_not_of(kBlank) - begin + 1);
}

template <class Function>
void for_each_line_of(std::string_view text, const Function& function) {
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = text.find('\n');
    function(number, text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
}

/// What follows "Marker/Key" or "Marker\Key" in a line of an .ini, a YAML or a command line.
std::optional<std::string> value_in_line(std::string_view line, std::string_view key) {
  for (const char slash : {'/', '\\'}) {
    const std::string name = fmt::format("Marker{}{}", slash, key);
    const std::size_t at = line.find(name);
    if (at == std::string_view::npos) continue;
    std::string_view rest = line.substr(at + name.size());
    const std::size_t begin = rest.find_first_not_of(" \t\"'=:");
    if (!rest.empty() && std::string_view(" \t\"'=:").find(rest.front()) == std::string_view::npos) continue;
    rest = begin == std::string_view::npos ? "" : rest.substr(begin);
    return std::string(without_blanks(rest.substr(0, rest.find_first_of("\"'"))));
  }
  return std::nullopt;
}

std::optional<RtabmapValue> value_called(const MapText& text, std::string_view key) {
  std::optional<RtabmapValue> found;
  for_each_line_of(text.text, [&](std::size_t number, std::string_view line) {
    if (found || line.starts_with('#') || line.starts_with(';')) return;
    if (const auto value = value_in_line(line, key)) found = RtabmapValue{*value, number};
  });
  return found;
}

/// One marker each, with its line.
std::vector<RtabmapValue> split_priors(const std::string& text, std::size_t first_line, bool counts_lines) {
  std::vector<RtabmapValue> markers;
  for_each_line_of(text, [&](std::size_t number, std::string_view line) {
    line = without_blanks(line);
    if (line.starts_with('#')) return;
    while (!line.empty()) {
      const std::size_t bar = line.find('|');
      const std::string_view marker = without_blanks(line.substr(0, bar));
      if (!marker.empty()) markers.push_back({std::string(marker), counts_lines ? number : first_line});
      line.remove_prefix(bar == std::string_view::npos ? line.size() : bar + 1);
    }
  });
  return markers;
}

/// Of a text that is nothing but markers; others are not read further than their first line that is no
/// comment.
std::optional<std::string> first_marker(std::string_view text) {
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    const std::string_view line = without_blanks(text.substr(0, end));
    if (!line.empty() && !line.starts_with('#'))
      return std::string(without_blanks(line.substr(0, line.find('|'))));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
  return std::nullopt;
}

std::vector<RtabmapValue> priors_of(const MapText& text) {
  const auto value = value_called(text, "Priors");
  return value ? split_priors(value->text, value->line, false) : split_priors(text.text, 1, true);
}

std::vector<std::optional<double>> numbers_in(const std::string& text) {
  std::vector<std::optional<double>> numbers;
  std::istringstream stream(text);
  for (std::string word; stream >> word;) numbers.push_back(parse_double(word));
  return numbers;
}

bool looks_like_prior(const std::string& text) {
  const auto numbers = numbers_in(text);
  const bool has_count = numbers.size() == 7 || numbers.size() == 8 || numbers.size() == 13;
  return has_count && std::ranges::all_of(numbers, [](const auto& number) { return number.has_value(); }) &&
         parse_integer(text.substr(0, text.find_first_of(" \t")));
}

Pose pose_of_prior(const std::vector<double>& v, const MapPlace& place) {
  const auto position = [&](double x, double y, double z) {
    for (const double coordinate_m : {x, y, z}) {
      if (const auto fault = fault_of_coordinate(coordinate_m)) place.fail(*fault);
    }
    return Eigen::Vector3d(x, y, z);
  };
  if (v.size() == 6) {
    for (const double angle_rad : {v[3], v[4], v[5]})
      if (std::abs(angle_rad) > 2.0 * std::numbers::pi)
        place.fail(
            fmt::format("roll, pitch and yaw are in radians, and {} is more than a whole turn", angle_rad));
  }
  if (v.size() == 6) return {rotation_of_roll_pitch_yaw({v[3], v[4], v[5]}), position(v[0], v[1], v[2])};
  if (v.size() == 7) {
    const Eigen::Quaterniond rotation(v[6], v[3], v[4], v[5]);
    if (const auto fault = fault_of_quaternion(rotation)) place.fail(*fault);
    return {rotation, position(v[0], v[1], v[2])};
  }
  const Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> matrix(v.data());
  return {checked_rotation(matrix.leftCols<3>(), place), position(v[3], v[7], v[11])};
}

ForeignTag tag_of_prior(const RtabmapValue& marker, const std::string& file) {
  ForeignTag tag;
  tag.place = {fmt::format("{}:{}", file, marker.line), fmt::format("marker '{}'", marker.text)};
  std::vector<double> values;
  for (const auto& number : numbers_in(marker.text)) {
    if (!number || !std::isfinite(*number)) tag.place.fail("must be finite numbers");
    values.push_back(*number);
  }
  const auto id = parse_integer(marker.text.substr(0, marker.text.find_first_of(" \t")));
  if (values.size() != 7 && values.size() != 8 && values.size() != 13)
    tag.place.fail(
        fmt::format("must be an id and 6 numbers (x y z roll pitch yaw), 7 (x y z qx qy qz qw) or 12 (a "
                    "3x4 matrix); it has {} numbers",
                    values.size()));
  if (!id || *id < 0 || *id > 1'000'000) tag.place.fail("must begin with the id of a tag");
  tag.id = static_cast<int>(*id);
  tag.T_map_tag =
      pose_from_frame(pose_of_prior({values.begin() + 1, values.end()}, tag.place), rotation_opencv_tag());
  return tag;
}

/// Above 0; nullopt where the file does not have it.
std::optional<double> positive_value(const MapText& text, std::string_view key) {
  const auto value = value_called(text, key);
  if (!value) return std::nullopt;
  const auto number = parse_double(value->text);
  if (!number || !std::isfinite(*number) || *number < 0.0)
    throw invalid_input(fmt::format("{}:{}", text.file, value->line),
                        fmt::format("Marker/{}: must be a number >= 0 (is '{}')", key, value->text));
  return *number > 0.0 ? number : std::nullopt;
}

std::optional<std::string> rtabmap_family(const MapText& text) {
  const auto value = value_called(text, "Dictionary");
  if (!value) return std::nullopt;
  for (const auto& [number, family] : kRtabmapDictionaries) {
    if (value->text == std::to_string(number)) return std::string(family);
  }
  throw invalid_input(
      fmt::format("{}:{}", text.file, value->line),
      fmt::format(
          "Marker/Dictionary: must be 20 (tag36h11), 19 (tag36h10), 18 (tag25h9) or 17 (tag16h5): '{}' is no "
          "dictionary of AprilTags",
          value->text));
}

std::optional<Matrix6d> rtabmap_covariance(const MapText& text) {
  const auto linear = positive_value(text, "PriorsVarianceLinear");
  const auto angular = positive_value(text, "PriorsVarianceAngular");
  if (!linear || !angular) return std::nullopt;
  Matrix6d covariance = Matrix6d::Zero();
  covariance.diagonal() << Eigen::Vector3d::Constant(*linear), Eigen::Vector3d::Constant(*angular);
  return covariance;
}

std::string text_of_prior(const MapTag& tag) {
  const Pose pose = pose_to_frame(tag.T_map_tag, rotation_opencv_tag());
  const Eigen::Vector3d& p = pose.translation();
  const Eigen::Vector3d angles = roll_pitch_yaw_of(pose.rotation());
  return fmt::format("{} {} {} {} {} {} {}", tag.key.id, format_exact(p.x()), format_exact(p.y()),
                     format_exact(p.z()), format_exact(angles.x()), format_exact(angles.y()),
                     format_exact(angles.z()));
}

/// One variance for all tags: the largest in any direction, so that none claims more than it knows.
struct CommonVariance {
  double linear_m2 = 0.0, angular_rad2 = 0.0;
};

double largest_variance(const Eigen::Matrix3d& covariance) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance, Eigen::EigenvaluesOnly).eigenvalues()[2];
}

std::optional<CommonVariance> common_variance(const TagMap& map) {
  CommonVariance variance;
  for (const MapTag& tag : map.tags) {
    if (!tag.covariance) return std::nullopt;
    variance.linear_m2 =
        std::max(variance.linear_m2, largest_variance(tag.covariance->topLeftCorner<3, 3>()));
    variance.angular_rad2 =
        std::max(variance.angular_rad2, largest_variance(tag.covariance->bottomRightCorner<3, 3>()));
  }
  if (!(variance.linear_m2 > 0.0 && variance.angular_rad2 > 0.0)) return std::nullopt;
  return variance;
}

}  // namespace

bool is_rtabmap(const MapText& text) {
  const bool has_key = text.text.find("Marker/Priors") != std::string::npos ||
                       text.text.find("Marker\\Priors") != std::string::npos;
  if (has_key) return value_called(text, "Priors").has_value();
  const auto marker = first_marker(text.text);
  return marker && looks_like_prior(*marker);
}

MapReading read_rtabmap(const MapText& text, const MapReadOptions& options) {
  const auto family = rtabmap_family(text);
  const auto size_m = positive_value(text, "Length");
  const auto covariance = rtabmap_covariance(text);
  std::vector<ForeignTag> tags;
  for (const RtabmapValue& marker : priors_of(text)) {
    ForeignTag tag = tag_of_prior(marker, text.file);
    tag.family = family;
    tag.size_m = size_m;
    tag.covariance = covariance;
    tags.push_back(std::move(tag));
  }
  return map_of(MapFormat::kRtabmap, options, text.file, "world", tags, {},
                {"RTAB-Map has it in Marker/Length"});
}

std::string write_rtabmap(const TagMap& map, const MapWriteOptions&, const std::string& file,
                          std::vector<ConversionLoss>& losses) {
  require_distinct_ids(map, MapFormat::kRtabmap, file);
  TagMap written = map;
  std::erase_if(written.tags, [](const MapTag& tag) { return tag.key.id == 0; });
  if (written.tags.empty())
    throw invalid_input(file, "RTAB-Map passes over id 0, and the map has no other: nothing would be left");
  if (written.tags.size() < map.tags.size())
    losses.push_back({.kind = LossKind::kTags,
                      .which = {to_string(
                          std::ranges::find(map.tags, 0, [](const MapTag& tag) { return tag.key.id; })->key)},
                      .value = "id 0, which RTAB-Map passes over"});
  const MapTag& first = written.tags.front();
  const bool is_one_size =
      std::ranges::all_of(written.tags, [&](const MapTag& tag) { return tag.size_m == first.size_m; });
  const auto dictionary =
      std::ranges::find(kRtabmapDictionaries, first.key.family, &std::pair<int, std::string_view>::second);
  const bool is_one_dictionary =
      dictionary != kRtabmapDictionaries.end() && std::ranges::all_of(written.tags, [&](const MapTag& tag) {
        return tag.key.family == first.key.family;
      });
  const auto variance = common_variance(written);
  if (variance)
    losses.push_back({.kind = LossKind::kCovariance,
                      .how = LossHow::kConverted,
                      .value = "the largest variances, for all tags"});
  add_left_out(written,
               {.sizes = is_one_size,
                .families = is_one_dictionary,
                .covariances = variance.has_value(),
                .frame_name = map.frame == "world"},
               losses);
  std::string priors;
  for (const MapTag& tag : written.tags) {
    if (!priors.empty()) priors += '|';
    priors += text_of_prior(tag);
  }
  std::string out = "[Core]\n";
  if (is_one_dictionary) out += fmt::format("Marker\\Dictionary = {}\n", dictionary->first);
  if (is_one_size) out += fmt::format("Marker\\Length = {}\n", format_exact(first.size_m));
  out += fmt::format("Marker\\Priors = {}\n", priors);
  if (variance)
    out += fmt::format("Marker\\PriorsVarianceAngular = {}\nMarker\\PriorsVarianceLinear = {}\n",
                       format_exact(variance->angular_rad2), format_exact(variance->linear_m2));
  return out;
}

}  // namespace apriltrack
