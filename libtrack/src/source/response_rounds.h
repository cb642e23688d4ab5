#pragma once

#include <cstddef>
#include <optional>

#include "apriltrack/source/frame_source.h"

namespace apriltrack {

inline constexpr int kSampleRounds = 4;

/// Frames of one round of response_of_sample(): first_frames or some more of `count`, spread evenly, none of
/// which an earlier round has. nullopt where there are none left. all: of the run; round: 0 to
/// kSampleRounds - 1.
std::optional<SourceOptions> frames_of_round(const SourceOptions& all, std::size_t count, int round,
                                             std::size_t first_frames);

}  // namespace apriltrack
