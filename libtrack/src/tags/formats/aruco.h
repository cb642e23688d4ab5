#pragma once

#include "formats.h"

namespace apriltrack {

bool is_aruco_marker_map(const MapText& text);
MapReading read_aruco_marker_map(const MapText& text, const MapReadOptions& options);
std::string write_aruco_marker_map(const TagMap& map, const MapWriteOptions& options, const std::string& file,
                                   std::vector<ConversionLoss>& losses);

/// OpenCV writes `{ id:0, corners:[ ... ] }`, which is no mapping to other readers of YAML: blanks are put
/// behind these colons. Lines keep their numbers.
std::string with_blanks_after_keys(const std::string& text);

}  // namespace apriltrack
