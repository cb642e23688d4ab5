#pragma once

#include "foreign_map.h"
#include "formats.h"

namespace apriltrack {

/// What to say of layouts without sizes.
extern const UsualSizes kFrcSizes;

bool is_wpilib_json(const MapText& text);
MapReading read_wpilib_json(const MapText& text, const MapReadOptions& options);
std::string write_wpilib_json(const TagMap& map, const MapWriteOptions& options, const std::string& file,
                              std::vector<ConversionLoss>& losses);

bool is_wpilib_csv(const MapText& text);
MapReading read_wpilib_csv(const MapText& text, const MapReadOptions& options);
std::string write_wpilib_csv(const TagMap& map, const MapWriteOptions& options, const std::string& file,
                             std::vector<ConversionLoss>& losses);

}  // namespace apriltrack
