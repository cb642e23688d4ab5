#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "apriltrack/base/error.h"
#include "apriltrack/base/timestamp.h"
#include "apriltrack/tags/tag_key.h"

namespace apriltrack {

// What is known of a map beside its images. Every sigma is a standard deviation of what was measured, taken
// as it is. A tag without a family is the one that was seen with the id.

/// Measured coordinates of a tag's centre in the map frame, all three or some.
struct PositionConstraint {
  TagKey tag;
  std::array<std::optional<double>, 3> position_m;
  double sigma_m = 0.0;  ///< Of each coordinate.
};

/// From centre to centre.
struct DistanceConstraint {
  TagKey a, b;
  double distance_m = 0.0;
  double sigma_m = 0.0;
};

/// Where tag b is on the board of tag a: T_a_b.
struct RelativePoseConstraint {
  TagKey a, b;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  std::optional<Eigen::Quaterniond> orientation;
  double sigma_m = 0.0;             ///< Of each coordinate.
  std::optional<double> sigma_rad;  ///< About each axis; given where the orientation is.
};

/// Centres in one plane, wherever it is, and normals, which all point to the same side, along its normal.
struct CoplanarConstraint {
  std::vector<TagKey> tags;
  double sigma_m = 0.0;             ///< Of a centre off the plane.
  std::optional<double> sigma_rad;  ///< Of a normal about each axis of the plane; none: normals are free.
};

/// The tag's y axis (down) points along -z of the map: it hangs upright, wherever it faces.
struct UprightConstraint {
  TagKey tag;
  double sigma_rad = 0.0;  ///< About each horizontal axis.
};

/// The tag lies face up in the plane z = 0 of the map.
struct FloorConstraint {
  TagKey tag;
  double sigma_m = 0.0;             ///< Of its centre's height.
  std::optional<double> sigma_rad;  ///< Of its tilt about each horizontal axis; none: it is free.
};

/// Which way things fall (-z of the map), in the frame of a tag.
struct GravityConstraint {
  TagKey tag;
  Eigen::Vector3d direction_tag = Eigen::Vector3d::UnitY();  ///< Of any length but 0.
  double sigma_rad = 0.0;                                    ///< About each horizontal axis.
};

/// The same in the frame of a camera, at the time of one of its frames (a tripod's level, an accelerometer at
/// rest).
struct CameraGravityConstraint {
  std::string camera;
  Timestamp timestamp;
  Eigen::Vector3d direction_camera = Eigen::Vector3d::UnitY();  ///< Of any length but 0.
  double sigma_rad = 0.0;                                       ///< About each horizontal axis.
};

struct MapConstraint {
  using What =
      std::variant<PositionConstraint, DistanceConstraint, RelativePoseConstraint, CoplanarConstraint,
                   UprightConstraint, FloorConstraint, GravityConstraint, CameraGravityConstraint>;

  What what;
  std::string name = {};   ///< For messages; empty: made from type and tags.
  std::string where = {};  ///< "constraints.yaml:14", for messages; empty: not from a file.
};

/// Whether it tells where the map's frame is, and not of tags among each other alone.
bool is_of_frame(const MapConstraint& constraint);
/// "distance", "relative_pose", ...: as in the file.
std::string type_of(const MapConstraint& constraint);
/// None of a camera's gravity.
std::vector<TagKey> tags_of(const MapConstraint& constraint);
/// Its name, or one such as "distance 3-4".
std::string title_of(const MapConstraint& constraint);
/// Throws Error(kInvalidInput) that names the constraint, its member, the value and the range.
void check_constraint(const MapConstraint& constraint);

/// Reads a constraint file (docs/file_formats.md). Throws Error(kIo) when it cannot be read,
/// Error(kInvalidInput) with file, line and key when it is wrong. Several tags of `upright` and `floor`
/// become a constraint each.
std::vector<MapConstraint> read_map_constraints(const std::filesystem::path& path);

/// One number of a constraint against what all else says.
struct ConstraintReading {
  std::string name;  ///< "distance", "x", "tilt of tag36h11/7", ...
  std::string unit;  ///< "m" or "rad".
  double measured = 0.0;
  std::optional<double> predicted;  ///< By all else; none where nothing else tells.
  std::optional<double> sigma;      ///< Of predicted - measured: both errors.

  /// How many of these the two are apart; -1 where nothing else tells.
  double sigmas_off() const;
};

/// What leaving out one constraint tells of it.
struct ConstraintAudit {
  std::string title;
  std::string type;
  std::vector<TagKey> tags;
  bool is_used = false;
  std::string reason;  ///< Why it is not used.
  std::vector<ConstraintReading> readings;
  /// Standard deviations between it and all else: of several numbers, as many as would be as unlikely of one
  /// (Wilson and Hilferty). None where nothing else tells.
  std::optional<double> z;
};

/// No map keeps to the constraints: they contradict each other or the images, or do not tell one frame.
class ConstraintError : public Error {
 public:
  ConstraintError(std::string_view what, std::vector<ConstraintAudit> audits);

  /// Of all constraints, in the order they were given.
  const std::vector<ConstraintAudit>& audits() const { return audits_; }

 private:
  std::vector<ConstraintAudit> audits_;
};

/// Both with as many decimals as tell them apart: `least` or more, 12 at most.
std::pair<std::string, std::string> told_apart(double a, double b, int least);

}  // namespace apriltrack
