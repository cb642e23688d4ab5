#include "formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "../own_map.h"
#include "apriltag_ros.h"
#include "apriltrack/base/error.h"
#include "apriltrack/io/input_file.h"
#include "aruco.h"
#include "foreign_map.h"
#include "kalibr_grid.h"
#include "limelight.h"
#include "rtabmap.h"
#include "tagslam.h"
#include "wpilib.h"

namespace apriltrack {
namespace {

bool is_own_map(const MapText& text) {
  return text.root && text.root->is_map() && text.root->find("apriltrack_map");
}

MapReading read_own_map(const MapText& text, const MapReadOptions& options) {
  MapReading reading{own_map_of(*text.root), MapFormat::kAprilTrack, {}};
  check_agreement(reading.map, options, text.file);
  return reading;
}

std::string write_own_map(const TagMap& map, const MapWriteOptions&, const std::string&,
                          std::vector<ConversionLoss>&) {
  return own_map_text(map);
}

/// Words by which the formats in YAML are known: a text without any of them is none of these, however it is
/// written.
constexpr std::array<std::string_view, 9> kYamlWords = {"apriltrack_map",  "frame:",      "tag_bundles",
                                                        "standalone_tags", "bodies",      "static_objects",
                                                        "aruco_bc",        "target_type", "ros__parameters"};

bool may_be_layout(const std::string& text) {
  return std::ranges::any_of(kYamlWords,
                             [&](std::string_view word) { return text.find(word) != std::string::npos; });
}

/// nullopt of what is no YAML, and no layout that would be.
std::optional<YamlNode> yaml_root_of(const std::string& text, const std::string& file) {
  try {
    return YamlNode::read_text(with_blanks_after_keys(text), file);
  } catch (const Error&) {
    if (may_be_layout(text)) throw;
    return std::nullopt;
  }
}

/// nullopt of what is neither JSON nor YAML.
std::optional<YamlNode> root_of(const std::string& text, const std::string& file) {
  const std::size_t first = text.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  const bool may_be_json = first != std::string::npos && (text[first] == '{' || text[first] == '[');
  if (!may_be_json) return yaml_root_of(text, file);
  try {
    return YamlNode::read_json_text(text, file);
  } catch (const Error& json_error) {
    try {  // YAML may begin with a brace, too
      return YamlNode::read_text(text, file);
    } catch (const Error&) {
      throw json_error;
    }
  }
}

constexpr NameEnding kOwnYaml[] = {{".yaml", true}, {".yml", true}};
constexpr NameEnding kYaml[] = {{".yaml"}, {".yml"}};
constexpr NameEnding kJson[] = {{".json"}};
constexpr NameEnding kCsv[] = {{".csv"}};
constexpr NameEnding kFmap[] = {{".fmap", true}};
constexpr NameEnding kIni[] = {{".ini", true}};

}  // namespace

const std::vector<MapFormatCode>& map_format_codes() {
  using enum MapFormat;
  static const std::vector<MapFormatCode> codes = {
      {{kAprilTrack, "apriltrack", "map of AprilTrack", "begins with 'apriltrack_map: 1'", kOwnYaml},
       is_own_map,
       read_own_map,
       write_own_map},
      {{kWpilibJson, "wpilib", "field layout of WPILib (JSON)", "tags with ID and pose, field", kJson},
       is_wpilib_json,
       read_wpilib_json,
       write_wpilib_json},
      {{kWpilibCsv, "wpilib-csv", "field layout of WPILib (CSV)", "header ID,X,Y,Z,Rotation", kCsv},
       is_wpilib_csv,
       read_wpilib_csv,
       write_wpilib_csv},
      {{kLimelight, "limelight", "field map of Limelight (.fmap)", "fiducials with transform", kFmap},
       is_fmap,
       read_fmap,
       write_fmap},
      {{kAprilTagRos, "apriltag_ros", "tags.yaml of apriltag_ros (ROS 1)", "tag_bundles, standalone_tags",
        kYaml},
       is_apriltag_ros,
       read_apriltag_ros,
       write_apriltag_ros},
      {{kAprilTagRos2, "apriltag_ros2", "parameter file of apriltag_ros (ROS 2)",
        "ros__parameters with tag_bundles", kYaml},
       is_apriltag_ros2,
       read_apriltag_ros2,
       write_apriltag_ros2},
      {{kTagSlam, "tagslam", "poses.yaml of TagSLAM", "bodies with tags", kYaml},
       is_tagslam,
       read_tagslam,
       write_tagslam},
      {{kArucoMarkerMap, "aruco", "marker map of the aruco library", "aruco_bc_markers", kYaml},
       is_aruco_marker_map,
       read_aruco_marker_map,
       write_aruco_marker_map},
      {{kKalibrAprilGrid, "kalibr", "target file of Kalibr", "target_type: aprilgrid", kYaml},
       is_kalibr_grid,
       read_kalibr_grid,
       write_kalibr_grid},
      // The last: its lines of numbers have no mark of their own.
      {{kRtabmap, "rtabmap", "list of marker priors of RTAB-Map",
        "Marker/Priors, or lines of id x y z roll pitch yaw", kIni},
       is_rtabmap,
       read_rtabmap,
       write_rtabmap},
  };
  return codes;
}

MapText load_map_text(const std::filesystem::path& path) {
  MapText text{path.string(), read_file(path), std::nullopt};
  if (text.text.find_first_not_of(" \t\r\n") == std::string::npos) throw invalid_input(text.file, "is empty");
  if (!is_wpilib_csv(text) && !is_rtabmap(text)) text.root = root_of(text.text, text.file);
  return text;
}

}  // namespace apriltrack
