#pragma once

#include "formats.h"

namespace apriltrack {

bool is_rtabmap(const MapText& text);
MapReading read_rtabmap(const MapText& text, const MapReadOptions& options);
std::string write_rtabmap(const TagMap& map, const MapWriteOptions& options, const std::string& file,
                          std::vector<ConversionLoss>& losses);

}  // namespace apriltrack
