#pragma once

#include "formats.h"

namespace apriltrack {

bool is_fmap(const MapText& text);
MapReading read_fmap(const MapText& text, const MapReadOptions& options);
std::string write_fmap(const TagMap& map, const MapWriteOptions& options, const std::string& file,
                       std::vector<ConversionLoss>& losses);

}  // namespace apriltrack
