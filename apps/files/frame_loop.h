#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "apriltrack/source/detect_frames.h"
#include "cli/console.h"

namespace apriltrack::app {

/// Null, or {"black", "white", "bits"}; bits: null where the range is none of so many bits.
nlohmann::json value_range_json(const std::optional<ValueRange>& range);

/// apriltrack::detect_frames() with its progress on the console, ended by Ctrl-C. It warns of that, of
/// unreadable frames and of copies before it returns, so that users hear the cause before what follows from
/// it. options: without progress and should_stop.
FrameCounts detect_frames(FrameSource& source, DetectFramesOptions options, const Console& console,
                          const std::function<void(DetectedFrame)>& sink);

}  // namespace apriltrack::app
