// MarkerMap of the aruco library (markermap.cpp there): OpenCV's FileStorage with aruco_bc_dict,
// aruco_bc_nmarkers, aruco_bc_mInfoType (0: pixels, 1: metres) and aruco_bc_markers, a list of id and four
// corners: top left, top right, bottom right, bottom left, as whoever looks at the marker sees them.
#include "aruco.h"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <array>

#include "../tag_faults.h"
#include "apriltrack/base/error.h"
#include "apriltrack/io/numbers.h"
#include "apriltrack/tags/tag_corners.h"
#include "foreign_map.h"
#include "map_words.h"

namespace apriltrack {
namespace {

constexpr int kMetres = 1;
/// Largest distance of a corner from the best square, over its edge: what rounding to millimetres leaves of a
/// small tag.
constexpr double kMaxMisfit = 0.01;
/// Ours (bottom left, bottom right, top right, top left) of aruco's.
constexpr std::array<std::size_t, 4> kArucoCornerOfOurs = {3, 2, 1, 0};
/// AprilTag dictionaries by their names in aruco's dictionary.cpp.
constexpr std::array<std::pair<std::string_view, std::string_view>, 4> kArucoDictionaries = {
    {{"TAG36h11", "tag36h11"}, {"TAG36h10", "tag36h10"}, {"TAG25h9", "tag25h9"}, {"TAG16h5", "tag16h5"}}};

using Corners = std::array<Eigen::Vector3d, 4>;

std::optional<std::string> aruco_family(const YamlNode& root) {
  const auto node = root.find("aruco_bc_dict");
  if (!node || node->is_null() || node->as_string().empty()) return std::nullopt;
  const std::string text = node->as_string();
  for (const auto& [dictionary, family] : kArucoDictionaries) {
    if (text == dictionary || text == family) return std::string(family);
  }
  node->fail(fmt::format(
      "'{}' is no dictionary of AprilTags, which alone are read here: TAG36h11, TAG36h10, TAG25h9, TAG16h5",
      text));
}

/// In our order.
Corners aruco_corners(const YamlNode& node) {
  const std::vector<YamlNode> items = node.items();
  if (items.size() != 4) node.fail(fmt::format("must be four corners (are {})", items.size()));
  Corners corners;
  for (std::size_t i = 0; i < 4; ++i) {
    const YamlNode& item = items[kArucoCornerOfOurs[i]];
    item.as_doubles(3);
    const std::vector<YamlNode> numbers = item.items();
    for (int k = 0; k < 3; ++k) corners[i][k] = read_coordinate(numbers[static_cast<std::size_t>(k)]);
  }
  return corners;
}

struct FittedSquare {
  double size_m = 0.0;
  Pose T_map_tag;
  double misfit_m = 0.0;  ///< The largest of a corner.
};

/// Umeyama's closed form (PAMI 1991) of scale, turn and shift from a square of edge 1.
FittedSquare fit_square(const Corners& corners) {
  const Corners unit = tag_corners(1.0);
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& corner : corners) centre += 0.25 * corner;
  Eigen::Matrix3d product = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < 4; ++i) product += (corners[i] - centre) * unit[i].transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(product, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d sign = Eigen::Matrix3d::Identity();
  sign(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  FittedSquare square;
  const Eigen::Matrix3d rotation = svd.matrixU() * sign * svd.matrixV().transpose();
  square.T_map_tag = Pose(rotation, centre);
  square.size_m =
      (sign * Eigen::Matrix3d(svd.singularValues().asDiagonal())).trace() / 2.0;  // sum of |unit|^2
  for (std::size_t i = 0; i < 4; ++i)
    square.misfit_m =
        std::max(square.misfit_m, (corners[i] - square.T_map_tag * (square.size_m * unit[i])).norm());
  return square;
}

ForeignTag aruco_tag(const YamlNode& node, const std::optional<std::string>& family) {
  const YamlNode corners = node.at("corners");
  const FittedSquare square = fit_square(aruco_corners(corners));
  if (!(square.misfit_m <= kMaxMisfit * square.size_m))
    corners.fail(fmt::format("are no square: the best one, of edge {:.4g} m, is up to {:.2g} m aside",
                             square.size_m, square.misfit_m));
  return {.place = MapPlace::of(node),
          .id = node.at("id").as_int(),
          .family = family,
          .size_m = square.size_m,
          .T_map_tag = square.T_map_tag};
}

std::string text_of_marker(const MapTag& tag) {
  const auto corners = corners_in_map(tag);
  std::string text;
  for (const std::size_t ours : kArucoCornerOfOurs) {
    const Eigen::Vector3d& p = corners[ours];
    text += fmt::format("{}[ {}, {}, {} ]", text.empty() ? "" : ",\n      ", yaml_double(p.x()),
                        yaml_double(p.y()), yaml_double(p.z()));
  }
  return fmt::format("   - {{ id: {}, corners: [ {} ] }}\n", tag.key.id, text);
}

std::string dictionary_of(const TagMap& map, const std::string& file) {
  const std::string& family = map.tags.front().key.family;
  for (const MapTag& tag : map.tags) {
    if (tag.key.family != family)
      throw invalid_input(file, fmt::format("a marker map has one dictionary, and the map has {} and {}",
                                            family, tag.key.family));
  }
  for (const auto& [dictionary, known] : kArucoDictionaries) {
    if (known == family) return std::string(dictionary);
  }
  throw invalid_input(
      file, fmt::format("the aruco library has no dictionary for {}: it has tag36h11, tag36h10, tag25h9 and "
                        "tag16h5",
                        family));
}

}  // namespace

std::string with_blanks_after_keys(const std::string& text) {
  if (text.find("aruco_bc_markers") == std::string::npos) return text;
  std::string mended;
  for (std::size_t i = 0; i < text.size(); ++i) {
    mended += text[i];
    const std::string_view so_far(mended);
    if (text[i] == ':' && (so_far.ends_with("id:") || so_far.ends_with("corners:"))) mended += ' ';
  }
  return mended;
}

bool is_aruco_marker_map(const MapText& text) {
  return text.root && text.root->is_map() && text.root->find("aruco_bc_markers");
}

MapReading read_aruco_marker_map(const MapText& text, const MapReadOptions& options) {
  const YamlNode& root = *text.root;
  const YamlNode unit = root.at("aruco_bc_mInfoType");
  if (unit.as_int() != kMetres)
    unit.fail(
        fmt::format("must be 1, metres (is {}): a map in pixels is a picture's; convert it by aruco's "
                    "MarkerMap::convertToMeters",
                    unit.as_string()));
  const auto family = aruco_family(root);
  std::vector<ForeignTag> tags;
  const std::vector<YamlNode> markers = root.at("aruco_bc_markers").items();
  for (const YamlNode& node : markers) tags.push_back(aruco_tag(node, family));
  if (const auto count = root.find("aruco_bc_nmarkers");
      count && count->as_int() != static_cast<int>(markers.size()))
    count->fail(
        fmt::format("is {}, and {} markers follow: is the file complete?", count->as_int(), markers.size()));
  return map_of(MapFormat::kArucoMarkerMap, options, text.file, "world", tags, {});
}

std::string write_aruco_marker_map(const TagMap& map, const MapWriteOptions&, const std::string& file,
                                   std::vector<ConversionLoss>& losses) {
  const std::string dictionary = dictionary_of(map, file);
  add_left_out(map, {.sizes = true, .families = true, .frame_name = map.frame == "world"}, losses);
  std::string out = fmt::format(
      "%YAML:1.0\n---\naruco_bc_dict: {}\naruco_bc_nmarkers: {}\naruco_bc_mInfoType: {}\naruco_bc_markers:\n",
      dictionary, map.tags.size(), kMetres);
  for (const MapTag& tag : map.tags) out += text_of_marker(tag);
  return out;
}

}  // namespace apriltrack
