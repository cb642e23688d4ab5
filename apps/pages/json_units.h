#pragma once

#include <nlohmann/json.hpp>

namespace apriltrack::app {

/// Of metres and radians in answers.
inline constexpr int kMetreDecimals = 8;

/// An answer in metres and radians, with the millimetres and degrees that 0.1 told beside them: `position_mm`
/// beside `position_m`, `rotation_deg` beside `rotation_rad`, at every depth. They go with 0.3.
nlohmann::json with_older_units(nlohmann::json answer);

}  // namespace apriltrack::app
