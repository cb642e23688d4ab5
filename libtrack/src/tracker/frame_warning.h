#pragma once

#include <optional>
#include <string>

#include "apriltrack/base/timestamp.h"

namespace apriltrack {

// What of a frame is not believed: the words of TrackResult::warning, empty where there is nothing to say.

/// Where what is told is none of a camera, and known_exposure_s() passes it over.
std::string exposure_warning(std::optional<double> of_frame, std::optional<double> of_camera);

/// Of a time that is so much earlier than the one before that another recording begins.
std::string new_recording_warning(Timestamp before, Timestamp time);

/// Both, where there are two.
std::string joined_warnings(const std::string& first, const std::string& second);

}  // namespace apriltrack
