#pragma once

#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "apriltrack/base/timestamp.h"

namespace apriltrack {

/// By the file's ending, in either case: .png .jpg .jpeg .pgm .ppm .pnm .bmp .tif .tiff .webp.
bool has_image_ending(const std::filesystem::path& path);

/// Files of a folder that end like images, hidden ones aside, in natural order.
/// Throws std::filesystem::filesystem_error when the folder cannot be read.
std::vector<std::filesystem::path> list_images(const std::filesystem::path& folder);

/// "9.png" before "10.png": runs of digits compare as numbers, all else as text; a strict order, so that no
/// listing depends on the file system.
bool natural_less(std::string_view a, std::string_view b);

/// The name before the ending, if it is all digits.
bool is_named_by_digits(const std::filesystem::path& path);
/// Whether it is digits, a point, and one to nine digits, as in folders of TUM's RGB-D benchmark
/// (1305031102.175304.png).
bool is_named_by_seconds(const std::filesystem::path& path);
/// Digits as nanoseconds, digits with a point as seconds, exactly; nullopt too when that is beyond 64 bits.
std::optional<Timestamp> time_in_name(const std::filesystem::path& path);

}  // namespace apriltrack
