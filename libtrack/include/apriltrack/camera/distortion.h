#pragma once

#include <variant>

#include "apriltrack/camera/equidistant.h"
#include "apriltrack/camera/no_distortion.h"
#include "apriltrack/camera/radtan.h"

namespace apriltrack {

/// The run-time choice of lens model; everything inside works on the concrete type.
using Distortion = std::variant<NoDistortion, RadtanDistortion, EquidistantDistortion>;

}  // namespace apriltrack
