#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "apriltrack/io/quoted_text.h"
#include "apriltrack/tags/map_formats.h"

namespace apriltrack {

/// format_exact() with a decimal point, as YAML 1.1 (PyYAML, rosparam) and ROS 2 want it: 1 and 1e-05 are no
/// floating-point numbers to them, 1.0 and 1.0e-05 are.
std::string yaml_double(double value);

/// A name of letters, digits and underscores that does not begin with a digit: what ROS takes as part of a
/// parameter's or a topic's name.
std::string ros_name(const std::string& text);

/// For formats that know tags by id alone. Throws Error(kInvalidInput) for an id in two families.
void require_distinct_ids(const TagMap& map, MapFormat format, const std::string& file);

}  // namespace apriltrack
