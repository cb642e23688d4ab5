#pragma once

#include "formats.h"

namespace apriltrack {

bool is_kalibr_grid(const MapText& text);
MapReading read_kalibr_grid(const MapText& text, const MapReadOptions& options);
std::string write_kalibr_grid(const TagMap& map, const MapWriteOptions& options, const std::string& file,
                              std::vector<ConversionLoss>& losses);

}  // namespace apriltrack
