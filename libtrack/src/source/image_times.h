#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "image_list.h"

namespace apriltrack {

/// Gives images their times. Names that are all digits are times in nanoseconds, digits with a point times in
/// seconds, whose median step a rate must agree with within a factor of 3; other ones get theirs from the
/// rate, in natural order. Beside a rate, digits are times where their median step agrees with it within a
/// factor of 3, else frame numbers where it is below 1000: time = number / rate. where: what messages call
/// the set. Throws Error(kInvalidInput) when there is no rate and no time, when only some names are times,
/// when two are the same (without a rate: less than a microsecond apart), or when digits are neither times
/// nor frame numbers of the rate.
std::vector<ImageEntry> give_times(const std::vector<std::filesystem::path>& images,
                                   std::optional<double> rate_hz, const std::string& where);

/// Adds exposure and gain of frames.csv to the images of the same time; rows without an image are passed
/// over, images without a row told to the log. Throws Error(kIo), or Error(kInvalidInput) with file, line,
/// column and value, or where there are rows and none is of an image.
void add_frame_facts(const std::filesystem::path& frames_csv, std::vector<ImageEntry>& images,
                     const LogSink& log);

}  // namespace apriltrack
