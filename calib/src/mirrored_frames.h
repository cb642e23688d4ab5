#pragma once

#include "part_adjustment.h"

namespace apriltrack {

/// Frames in which a view is far off may have been mirrored about a tag, which agrees with either pose. Tries
/// each in the poses that its tags propose one by one, the tags as they are, and keeps what explains its
/// views better. False when no frame was turned; else the caller adjusts again.
bool turn_mirrored_frames(const PartTask& task, const Part& part, MapState& state);

}  // namespace apriltrack
