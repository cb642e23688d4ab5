#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "image_list.h"

namespace apriltrack {

/// Gives images their times: from names that are all digits (nanoseconds), else from the rate, in natural
/// order. Where two of them are less than a microsecond apart they are no times of a camera: with a rate they
/// are taken for frame numbers. where: what messages call the set. Throws Error(kInvalidInput) when there is
/// no rate and no time, when only some names are times, or when without a rate two are so close.
std::vector<ImageEntry> give_times(const std::vector<std::filesystem::path>& images,
                                   std::optional<double> rate_hz, const std::string& where);

/// Adds exposure and gain of frames.csv to the images of the same time; rows without an image are passed
/// over. Throws Error(kIo), or Error(kInvalidInput) with file, line, column and value.
void add_frame_facts(const std::filesystem::path& frames_csv, std::vector<ImageEntry>& images);

}  // namespace apriltrack
