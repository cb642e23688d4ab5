#pragma once

#include <span>
#include <vector>

#include "doctor_facts.h"

namespace apriltrack::app {

/// Of each frame, whether an earlier one shows the same tags where it does, to a pixel (rms over a tag's
/// corners, as calibrate's CalibrationOptions::same_place_px): the camera stood still, or the frame is a
/// copy. calibrate takes all that one place shows for one picture. False of frames without tags.
std::vector<bool> are_at_rest(std::span<const FrameFacts> frames);

}  // namespace apriltrack::app
