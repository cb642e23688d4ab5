#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "apriltrack/io/yaml_reader.h"
#include "apriltrack/tags/map_formats.h"

namespace apriltrack {

// The door of this room: a file that was loaded, and what each format makes of it.

/// A file in memory.
struct MapText {
  std::string file;  ///< What messages call it.
  std::string text;
  std::optional<YamlNode> root;  ///< Where it is YAML or JSON.
};

/// One format. `read` takes a text that was recognised; `write` returns the whole file and adds to `losses`.
struct MapFormatCode {
  MapFormatInfo info;
  bool (*recognises)(const MapText& text);
  MapReading (*read)(const MapText& text, const MapReadOptions& options);
  std::string (*write)(const TagMap& map, const MapWriteOptions& options, const std::string& file,
                       std::vector<ConversionLoss>& losses);
};

const std::vector<MapFormatCode>& map_format_codes();

/// The sports field of a map whose origin is the field's corner or its centre.
struct StatedField {
  FieldSize size;
  Eigen::Vector2d centre_m;  ///< In the map.
};
/// nullopt where the map does not tell it.
std::optional<StatedField> stated_field(const TagMap& map);

/// Throws Error(kIo) when it cannot be read, Error(kInvalidInput) when it is too large to be a layout.
MapText load_map_text(const std::filesystem::path& path);

}  // namespace apriltrack
