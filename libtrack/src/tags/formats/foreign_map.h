#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "apriltrack/io/yaml_reader.h"
#include "apriltrack/tags/map_formats.h"
#include "apriltrack/tags/map_holdings.h"

namespace apriltrack {

/// Where something stands, for messages about it that come later.
struct MapPlace {
  std::string where;  ///< "field.json:14".
  std::string path;   ///< "tags[3]"; may be empty.

  static MapPlace of(const YamlNode& node) { return {node.where(), node.key_path()}; }
  [[noreturn]] void fail(const std::string& what) const;
};

/// A tag as another format has it, its pose already that of our tag frame.
struct ForeignTag {
  MapPlace place;
  int id = 0;
  std::optional<std::string> family = {};
  std::optional<double> size_m = {};
  Pose T_map_tag = {};
  std::optional<Matrix6d> covariance = {};
};

/// What follows in a message on missing sizes: which are usual.
struct UsualSizes {
  std::string_view text;
};

/// Makes a checked map of foreign tags: families and sizes that the file leaves open are taken from the
/// options, or refused. Adds to `losses` what was assumed. A map without tags is refused with `empty`.
MapReading map_of(MapFormat format, const MapReadOptions& options, const std::string& file,
                  const std::string& frame, const std::vector<ForeignTag>& tags,
                  std::vector<ConversionLoss> losses, UsualSizes usual = {});

/// Compares sizes and families of a map that states its own with what the caller gave. where: what messages
/// begin with.
void check_agreement(const TagMap& map, const MapReadOptions& options, const std::string& where);

/// Adds what the file has beyond `known` keys to `seen`, so that it can be told.
void note_foreign_keys(const YamlNode& node, std::initializer_list<std::string_view> known,
                       std::vector<std::string>& seen);
void add_foreign_keys(const std::vector<std::string>& seen, std::vector<ConversionLoss>& losses);

// Fields of other projects' files, with the rules of our own.

/// Finite, and on this Earth.
double read_coordinate(const YamlNode& node);
/// Of unit length but for rounding to three decimals.
Eigen::Quaterniond read_unit_quaternion(const YamlNode& node, double w, double x, double y, double z);
/// A rotation but for rounding to three decimals; the nearest one.
Eigen::Quaterniond checked_rotation(const Eigen::Matrix3d& matrix, const MapPlace& place);
/// What our tag frame is in that of apriltag_ros, TagSLAM and aruco: theirs has y up and z out of the face.
const Eigen::Quaterniond& rotation_ros_tag();
/// In that of OpenCV's aruco module, and so of RTAB-Map: y up and z out of the face as well, but of the print
/// as OpenCV's dictionaries of AprilTags have it, which is the AprilTag library's upside down.
const Eigen::Quaterniond& rotation_opencv_tag();
/// In that of WPILib and Limelight: theirs has x out of the face, y to the right of who looks at it, z up
/// (a tag of zero rotation is upright and faces along +x: AprilTagFieldLayout.java of wpilibsuite/allwpilib).
const Eigen::Quaterniond& rotation_wpilib_tag();

/// T_map_ours = T_map_theirs * T_theirs_ours.
Pose pose_from_frame(const Pose& T_map_theirs, const Eigen::Quaterniond& rotation_theirs_ours);
Pose pose_to_frame(const Pose& T_map_ours, const Eigen::Quaterniond& rotation_theirs_ours);
Matrix6d covariance_from_frame(const Matrix6d& theirs, const Eigen::Quaterniond& rotation_theirs_ours);
Matrix6d covariance_to_frame(const Matrix6d& ours, const Eigen::Quaterniond& rotation_theirs_ours);

}  // namespace apriltrack
