#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace apriltrack::app {

/// What an output is made of: it decides which endings its name may have, and which files it may replace.
enum class OutputKind { kText, kMcap, kVideo, kGlb };

/// Why an output of this kind may not have this name, whether or not such a file is there: it would be read
/// as a picture, video or bag, or as a part of the recording that it lies in. In words that follow the file's
/// name; nullopt where it may.
std::optional<std::string> fault_of_name(const std::filesystem::path& output, OutputKind kind);

/// Why a file that is there may not be replaced by an output of this kind: it is somebody's picture, video,
/// bag, or other binary file. As above.
std::optional<std::string> fault_of_replacing(const std::filesystem::path& output, OutputKind kind);

/// By the ending of its name, in either case.
bool has_picture_ending(const std::filesystem::path& path);

/// Whether a run that reads `input`, a folder that is a bag, would read a file of this name as a part of it.
bool is_part_of_bag(const std::filesystem::path& output, const std::string& input);

}  // namespace apriltrack::app
