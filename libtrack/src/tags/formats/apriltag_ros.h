#pragma once

#include "formats.h"

namespace apriltrack {

bool is_apriltag_ros(const MapText& text);
MapReading read_apriltag_ros(const MapText& text, const MapReadOptions& options);
std::string write_apriltag_ros(const TagMap& map, const MapWriteOptions& options, const std::string& file,
                               std::vector<ConversionLoss>& losses);

bool is_apriltag_ros2(const MapText& text);
MapReading read_apriltag_ros2(const MapText& text, const MapReadOptions& options);
std::string write_apriltag_ros2(const TagMap& map, const MapWriteOptions& options, const std::string& file,
                                std::vector<ConversionLoss>& losses);

}  // namespace apriltrack
