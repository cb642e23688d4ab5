#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apriltrack/io/conversion_loss.h"
#include "apriltrack/io/name_ending.h"
#include "apriltrack/tags/tag_map.h"
#include "apriltrack/tags/tag_sizes.h"

namespace apriltrack {

/// Files that tell where tags are, as other projects write them. All are read and written
/// (docs/file_formats.md: what each holds, in which frames).
enum class MapFormat {
  kAprilTrack,       ///< map.yaml.
  kWpilibJson,       ///< AprilTagFieldLayout.
  kWpilibCsv,        ///< FIRST's table in inches and degrees, as WPILib keeps it beside its JSON.
  kLimelight,        ///< .fmap.
  kAprilTagRos,      ///< apriltag_ros (ROS 1): tags.yaml with tag_bundles.
  kAprilTagRos2,     ///< ROS 2 parameters with tag_bundles.
  kTagSlam,          ///< poses.yaml, tagslam.yaml.
  kArucoMarkerMap,   ///< MarkerMap of the aruco library.
  kRtabmap,          ///< Marker/Priors.
  kKalibrAprilGrid,  ///< target.yaml.
};

struct MapFormatInfo {
  MapFormat format;
  std::string_view name;    ///< As `--to` takes it: "wpilib".
  std::string_view title;   ///< In a sentence: "WPILib field layout (JSON)".
  std::string_view marker;  ///< By what it is recognised, for people.
  std::span<const NameEnding> endings = {};
};

std::span<const MapFormatInfo> map_formats();
const MapFormatInfo& info_of(MapFormat format);
/// nullopt where there is none of that name.
std::optional<MapFormat> map_format_named(std::string_view name);
/// What a file to write is by the ending of its name; nullopt where that does not tell (.json, .csv).
std::optional<MapFormat> map_format_of_ending(const std::filesystem::path& path);

/// Of a sports field, along x and along y.
struct FieldSize {
  double length_m = 0.0;
  double width_m = 0.0;
};

/// What a file does not say. Where it does, it must agree.
struct MapReadOptions {
  TagSizes sizes = TagSizes();             ///< Of formats that hold none.
  std::optional<std::string> family = {};  ///< Of formats that hold none; tag36h11 without it.
  std::string bundle = {};                 ///< Which of several bundles or bodies; empty: the only one.
  std::optional<FieldSize> field = {};     ///< To move the origin from a field's centre to its corner.
  /// Sizes and family are passed over, in place of compared, where the file has its own.
  bool only_where_missing = false;
};

struct MapReading {
  TagMap map;
  MapFormat format = MapFormat::kAprilTrack;
  std::vector<ConversionLoss> losses;
};

/// By its contents, whatever its name. Throws Error(kIo) when it cannot be read, Error(kInvalidInput) that
/// lists the known formats when it is none of them.
MapFormat recognise_map_format(const std::filesystem::path& path);

/// Reads a layout of any known format. Poses become T_map_tag of our tag frame (docs/conventions.md).
///
/// Throws Error(kIo); Error(kInvalidInput) with file, line and key when it is wrong, is no layout (sizes
/// without poses, several bundles and none chosen), or has no sizes and `options` none either.
MapReading read_tag_map(const std::filesystem::path& path, const MapReadOptions& options);
/// The same of a file whose format is known.
MapReading read_tag_map_as(const std::filesystem::path& path, MapFormat format,
                           const MapReadOptions& options = {});

struct MapWriteOptions {
  std::optional<FieldSize> field = {};  ///< Where the map does not tell it.
};

/// Returns what the file does not hold. Throws Error(kInvalidInput) when the format cannot hold the map (an
/// id in two families, a tag that leans where only headings are written, no printed grid) and what
/// check_tag_map() throws; Error(kIo). An existing file is replaced only when the new one is complete.
std::vector<ConversionLoss> write_tag_map_as(const std::filesystem::path& path, const TagMap& map,
                                             MapFormat format, const MapWriteOptions& options = {});

}  // namespace apriltrack
