#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "apriltrack/detect/left_out_tags.h"

namespace apriltrack::app {

/// LeftOutTags::message() as a further sentence of a message: "; 3 readings ...", or empty.
std::string told_after(const LeftOutTags& left_out);
/// A list of {reason, readings, tags} (docs/file_formats.md).
nlohmann::json json_of(const LeftOutTags& left_out);

}  // namespace apriltrack::app
