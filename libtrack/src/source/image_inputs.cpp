#include "image_inputs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glob.h>

#include <algorithm>
#include <system_error>

#include "apriltrack/base/error.h"
#include "apriltrack/io/csv.h"
#include "image_names.h"
#include "image_times.h"

namespace apriltrack {
namespace fs = std::filesystem;
namespace {

constexpr const char* kImageEndings = ".png, .jpg, .jpeg, .pgm, .ppm, .pnm, .bmp, .tif, .tiff or .webp";

std::vector<fs::path> require_images(const fs::path& folder) {
  try {
    auto images = list_images(folder);
    if (images.empty())
      throw io_error(folder.string(), fmt::format("holds no images (files ending in {})", kImageEndings));
    return images;
  } catch (const fs::filesystem_error& error) {
    throw io_error(folder.string(), fmt::format("cannot be read: {}", error.code().message()));
  }
}

std::vector<fs::path> match(const std::string& pattern) {
  glob_t matches{};
  const int status = ::glob(pattern.c_str(), 0, nullptr, &matches);
  std::vector<fs::path> paths;
  for (std::size_t i = 0; status == 0 && i < matches.gl_pathc; ++i) paths.emplace_back(matches.gl_pathv[i]);
  ::globfree(&matches);
  return paths;
}

}  // namespace

std::vector<ImageEntry> list_sequence(const fs::path& folder, std::optional<double> rate_hz,
                                      const LogSink& log) {
  const fs::path frames = folder / "frames";
  auto entries = give_times(require_images(frames), rate_hz, frames.string());
  if (path_exists(folder / "frames.csv")) add_frame_facts(folder / "frames.csv", entries, log);
  return entries;
}

std::vector<ImageEntry> list_euroc_camera(const fs::path& camera_folder) {
  constexpr std::string_view kTime = "timestamp [ns]";
  constexpr std::string_view kFile = "filename";
  const CsvTable table =
      CsvTable::read_file(camera_folder / "data.csv", {std::string(kTime), std::string(kFile)});
  std::vector<ImageEntry> entries;
  for (std::size_t row = 0; row < table.num_rows(); ++row) {
    const Timestamp time{table.integer(row, kTime)};
    if (!entries.empty() && time <= entries.back().timestamp) {
      throw invalid_input(table.where(row), fmt::format("{}: must be later than the row before's {} (is {})",
                                                        kTime, entries.back().timestamp.ns, time.ns));
    }
    if (table.is_empty(row, kFile)) throw invalid_input(table.where(row), "filename: is empty");
    entries.push_back({.path = camera_folder / "data" / table.text(row, kFile), .timestamp = time});
  }
  if (entries.empty()) throw io_error((camera_folder / "data.csv").string(), "lists no images");
  return entries;
}

std::vector<ImageEntry> list_image_folder(const fs::path& folder, std::optional<double> rate_hz) {
  return give_times(require_images(folder), rate_hz, folder.string());
}

std::vector<ImageEntry> list_glob(const std::string& pattern, std::optional<double> rate_hz) {
  const std::vector<fs::path> matches = match(pattern);
  if (matches.empty()) throw io_error(pattern, "no file matches this pattern");
  std::vector<fs::path> images;
  std::error_code ignored;  // what cannot be looked at becomes an unreadable frame
  for (const fs::path& path : matches) {
    if (has_image_ending(path) && !fs::is_directory(path, ignored)) images.push_back(path);
  }
  if (images.empty()) {
    throw io_error(pattern,
                   fmt::format("matches {} files, but no images ({})", matches.size(), kImageEndings));
  }
  std::ranges::sort(images, natural_less, [](const fs::path& path) { return path.string(); });
  return give_times(images, rate_hz, pattern);
}

std::vector<ImageEntry> list_single_image(const fs::path& path) {
  return {{.path = path, .timestamp = time_in_name(path).value_or(Timestamp{})}};
}

bool path_exists(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) return false;
  if (error) throw io_error(path.string(), fmt::format("cannot be read: {}", error.message()));
  return true;
}

bool is_sequence_folder(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_directory(folder / "frames", ignored);
}

namespace {

/// Other sensors of a recording have a data.csv as well, but no folder of images beside it.
bool is_euroc_camera(const fs::path& folder) {
  std::error_code ignored;
  return fs::exists(folder / "data.csv", ignored) && fs::is_directory(folder / "data", ignored);
}

/// Names of the cameras of the recording that `folder` or its mav0 is.
std::vector<std::string> euroc_cameras(const fs::path& folder) {
  std::vector<std::string> names;
  for (const fs::path& recording : {folder, folder / "mav0"}) {
    std::error_code error;  // what cannot be listed holds no camera
    for (fs::directory_iterator entry(recording, error), end; !error && entry != end; entry.increment(error))
      if (is_euroc_camera(entry->path())) names.push_back(entry->path().filename().string());
  }
  std::ranges::sort(names, natural_less);
  return names;
}

}  // namespace

std::optional<fs::path> find_euroc_camera(const fs::path& folder, const std::string& name) {
  const std::string wanted = name.empty() ? "cam0" : name;
  for (const fs::path& camera : {folder, folder / wanted, folder / "mav0" / wanted}) {
    if (is_euroc_camera(camera)) return camera;
  }
  const std::vector<std::string> there = euroc_cameras(folder);
  if (there.empty()) return std::nullopt;
  throw invalid_input(folder.string(),
                      fmt::format("the recording has no camera '{}'; it has: {}; choose with --camera-name",
                                  wanted, fmt::join(there, ", ")));
}

bool is_glob(const std::string& input) {
  return input.find_first_of("*?[") != std::string::npos;
}

}  // namespace apriltrack
