#pragma once

namespace apriltrack {

/// For the rest of the process FFmpeg and OpenCV write nothing to stderr, which they do of every damaged
/// frame. Sources tell of damage in their own words (SourceOptions::log). For programs: it is not a library's
/// to decide.
void silence_decoders();

}  // namespace apriltrack
