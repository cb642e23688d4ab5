#pragma once

#include "formats.h"

namespace apriltrack {

bool is_tagslam(const MapText& text);
MapReading read_tagslam(const MapText& text, const MapReadOptions& options);
std::string write_tagslam(const TagMap& map, const MapWriteOptions& options, const std::string& file,
                          std::vector<ConversionLoss>& losses);

}  // namespace apriltrack
