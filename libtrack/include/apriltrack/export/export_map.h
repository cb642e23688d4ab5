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

namespace apriltrack {

/// What maps are written for and not read from: viewers, simulators, other solvers, tables.
enum class ExportFormat {
  kGltf,         ///< glTF 2.0, one text file, textures inside.
  kGlb,          ///< The same, binary.
  kUrdf,         ///< A link for each tag, fixed to the map's frame.
  kSdf,          ///< SDFormat 1.9: a static model.
  kColmap,       ///< COLMAP's text files, in a folder: the tags' corners as points.
  kG2o,          ///< Vertices with priors that come of covariances.
  kCornersCsv,   ///< Corners in millimetres.
  kCornersJson,  ///< Corners in millimetres.
};

struct ExportFormatInfo {
  ExportFormat format;
  std::string_view name;   ///< As `--to` takes it: "gltf".
  std::string_view title;  ///< In a sentence: "glTF scene".
  std::span<const NameEnding> endings = {};
  bool is_folder = false;
};

std::span<const ExportFormatInfo> export_formats();
const ExportFormatInfo& info_of(ExportFormat format);
std::optional<ExportFormat> export_format_named(std::string_view name);

/// One file of an export. name: in the folder; empty where the export is this file.
struct ExportedFile {
  std::string name;
  std::string contents;
};

struct MapExport {
  std::vector<ExportedFile> files;
  std::vector<ConversionLoss> losses;
};

/// Tags are in the map's frame, z of which is up for those formats that know an up (glTF is turned to y up).
/// A tag's own frame stays ours: x right, y down, z into the tag. map: as check_tag_map() lets pass.
MapExport export_tag_map(const TagMap& map, ExportFormat format);

/// Writes it: a file, or files into a folder that is made where it is missing. Returns what the files do not
/// hold. Throws what check_tag_map() throws, and Error(kIo); existing files are replaced by complete ones
/// only. Error(kInvalidInput) for a folder with a COLMAP model that this did not write.
std::vector<ConversionLoss> write_exported_map(const std::filesystem::path& path, const TagMap& map,
                                               ExportFormat format);

}  // namespace apriltrack
