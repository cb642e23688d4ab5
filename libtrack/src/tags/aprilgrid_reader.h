#pragma once

#include "apriltrack/io/yaml_reader.h"
#include "apriltrack/tags/aprilgrid.h"

namespace apriltrack {

/// Kalibr's target YAML. Complains with line and key.
AprilGrid aprilgrid_of(const YamlNode& root);

}  // namespace apriltrack
