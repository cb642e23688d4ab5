#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "image_list.h"

namespace apriltrack {

// Each kind of INPUT that is a set of images, as a list in the order of time. All throw Error(kIo) when there
// is nothing to read, Error(kInvalidInput) when times are missing, repeated or run backwards.

/// A folder with `frames/` inside it; exposure and gain from its frames.csv, which the log hears of where it
/// does not know all frames.
std::vector<ImageEntry> list_sequence(const std::filesystem::path& folder, std::optional<double> rate_hz,
                                      const LogSink& log);
/// One camera folder of a EuRoC/ASL recording, times from its data.csv. Images that are listed but missing
/// stay in the list: they are frames that cannot be read.
std::vector<ImageEntry> list_euroc_camera(const std::filesystem::path& camera_folder);
std::vector<ImageEntry> list_image_folder(const std::filesystem::path& folder, std::optional<double> rate_hz);
std::vector<ImageEntry> list_glob(const std::string& pattern, std::optional<double> rate_hz);
/// A lone image needs no rate: without a time in its name it is at 0 s.
std::vector<ImageEntry> list_single_image(const std::filesystem::path& path);

/// Throws Error(kIo) with the system's reason where that cannot be told (a loop of links, a closed folder).
bool path_exists(const std::filesystem::path& path);
bool is_sequence_folder(const std::filesystem::path& folder);
/// The camera folder that `folder` is, whatever its name, or holds under `name` (mav0 or its parent; empty:
/// cam0); nullopt when it is no such recording. Throws Error(kInvalidInput) that lists the cameras when it
/// has others only.
std::optional<std::filesystem::path> find_euroc_camera(const std::filesystem::path& folder,
                                                       const std::string& name);
bool is_glob(const std::string& input);

}  // namespace apriltrack
