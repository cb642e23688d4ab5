#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "apriltrack/geometry/pose.h"
#include "apriltrack/tags/tag_key.h"

namespace apriltrack {

/// How well a calibration knows one tag.
struct TagStatistics {
  int views = 0;                   ///< Frames in which the tag was used.
  double residual_rms_px = 0.0;    ///< Root mean square of its corner residuals per axis.
  std::vector<std::string> flags;  ///< Words such as "weak"; empty when all is well.
};

struct MapTag {
  TagKey key;
  double size_m = 0.0;
  Pose T_map_tag;
  /// Of the right perturbation of T_map_tag, [translation; rotation], relative to the map's gauge; all zero
  /// for a tag that the gauge holds.
  std::optional<Matrix6d> covariance;
  std::optional<TagStatistics> statistics;
  /// `x_...` keys of the tag, name and YAML text, kept on a round trip.
  std::vector<std::pair<std::string, std::string>> extensions;
};

/// Where tags are: in a world that the camera moves through, or on a rigid body that moves before the camera.
struct TagMap {
  std::string frame = "world";  ///< Name of the map frame; for a moving bundle, of its body.
  std::string default_family = "tag36h11";
  std::vector<MapTag> tags;  ///< Keys are unique.
  /// Key and value of the `provenance` block, in order: tool version, inputs, date, options, gauge.
  std::vector<std::pair<std::string, std::string>> provenance;
  /// `x_...` keys of the file, name and YAML text, kept on a round trip.
  std::vector<std::pair<std::string, std::string>> extensions;

  /// nullptr when the map does not have the tag.
  const MapTag* find(const TagKey& key) const;
};

/// Corners in the map frame, in corner order.
std::array<Eigen::Vector3d, 4> corners_in_map(const MapTag& tag);

/// Throws Error(kInvalidInput) that names the tag, its member and the value unless there are tags, of known
/// families and with ids that these have, each once; their sizes lie in (0, 100] m; poses and covariances are
/// finite, and covariances symmetric and positive semidefinite but for rounding. A map that was read has been
/// checked. where: what the message begins with.
void check_tag_map(const TagMap& map, std::string_view where = "map");

/// Reads map.yaml, or a layout of any other project that states sizes and families or leaves only families
/// open (tag36h11 then): map_formats.h says which, reads those without sizes, too, and tells what was
/// assumed. Throws Error(kIo) when the file cannot be read, Error(kInvalidInput) with file, line and key when
/// it is wrong.
TagMap read_tag_map(const std::filesystem::path& path);
/// Writes map.yaml. Numbers are written so that reading them gives the same doubles back. Throws what
/// check_tag_map() throws, and Error(kIo); an existing file is replaced only when the new one is complete.
void write_tag_map(const std::filesystem::path& path, const TagMap& map);

}  // namespace apriltrack
