#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "sampled_source.h"

namespace apriltrack {

/// A video file; a frame's time is the one that the file gives it, variable rates included.
/// rate_hz: only for files whose frames carry no times (raw streams); without one they are an
/// Error(kInvalidInput). Throws Error(kIo) when it cannot be opened or holds no frame.
/// log: hears at the end when the file holds fewer frames than its header promises.
std::unique_ptr<SkippableSource> open_video(const std::filesystem::path& path, std::optional<double> rate_hz,
                                            const LogSink& log);

/// A live camera by its number. Times are the driver's, or else those of arrival, on the machine's monotonic
/// clock, and stay as they are: they are not moved to the middle of the exposure. A frame whose time does not
/// run forward is unreadable. where: what messages call it. Throws Error(kIo) when it cannot be opened.
std::unique_ptr<SkippableSource> open_live_camera(int number, const std::string& where);

/// A bag's topic of pictures; messages are read, and turned grey, one by one. Of the options: topic, rate_hz
/// (for headers without a time), bits and log. Throws as open_source() does.
std::unique_ptr<SkippableSource> open_bag_source(const std::string& input, const SourceOptions& options);

}  // namespace apriltrack
