#include "kept_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <system_error>

#include "apriltrack/bag/bag_reader.h"
#include "apriltrack/bag/mcap_writer.h"
#include "apriltrack/base/error.h"
#include "apriltrack/io/input_file.h"
#include "apriltrack/io/lower_case.h"
#include "apriltrack/io/staged_files.h"

namespace apriltrack::app {
namespace {

namespace fs = std::filesystem;

/// What makes a sequence folder and a EuRoC camera (docs/file_formats.md): `name` beside the folder `images`.
struct RecordingFile {
  std::string_view name;
  std::string_view images;
};
constexpr std::array<RecordingFile, 6> kRecordingFiles = {{{"camera.yaml", "frames"},
                                                           {"map.yaml", "frames"},
                                                           {"frames.csv", "frames"},
                                                           {"truth.tum", "frames"},
                                                           {"data.csv", "data"},
                                                           {"sensor.yaml", "data"}}};
constexpr std::string_view kMetadata = "metadata.yaml";

constexpr std::array<std::string_view, 10> kPictures = {".png",  ".jpg",  ".jpeg", ".bmp", ".tif",
                                                        ".tiff", ".webp", ".pgm",  ".ppm", ".pnm"};
constexpr std::array<std::string_view, 6> kVideos = {".mp4", ".m4v", ".mov", ".avi", ".mkv", ".webm"};
constexpr std::array<std::string_view, 4> kBags = {".bag", ".db3", ".mcap", ".zstd"};

template <std::size_t N>
bool has(const std::array<std::string_view, N>& endings, const std::string& ending) {
  return std::ranges::find(endings, ending) != endings.end();
}

/// What files of this ending are; nullopt of others.
std::optional<std::string_view> thing_of(const std::string& ending) {
  if (has(kPictures, ending)) return "picture";
  if (has(kVideos, ending)) return "video";
  if (has(kBags, ending)) return "bag";
  return std::nullopt;
}

bool is_own_ending(const std::string& ending, OutputKind kind) {
  return kind == OutputKind::kVideo || (kind == OutputKind::kMcap && ending == ".mcap");
}

/// A name that is not taken yet, too: a trajectory called frames.csv would be read as exposures ever after.
/// But a map of its own is what a recording that has none is calibrated for.
bool is_recordings_own(const fs::path& file) {
  std::error_code error;
  if (file.filename() == kMetadata && is_bag(file.parent_path())) return true;
  if (file.filename() == "map.yaml" && !fs::exists(file, error)) return false;
  return std::ranges::any_of(kRecordingFiles, [&](const RecordingFile& own) {
    return file.filename() == own.name && fs::is_directory(file.parent_path() / own.images, error);
  });
}

bool is_own_mcap(const fs::path& path) {
  return mcap_library(path).value_or("").starts_with(kMcapLibrary);
}

/// Texts have no zero byte. Of a file that cannot be read nobody knows.
bool is_binary(const std::string& start) {
  return start.find('\0') != std::string::npos;
}

std::string start_of(const fs::path& path) {
  constexpr std::size_t kEnough = 4096;
  std::string bytes(kEnough, ' ');
  try {
    bytes.resize(InputFile(path).read(0, bytes.data(), bytes.size()));
  } catch (const Error&) {
    bytes.clear();
  }
  return bytes;
}

}  // namespace

std::optional<std::string> fault_of_name(const fs::path& output, OutputKind kind) {
  const fs::path file = written_file(output);
  if (is_recordings_own(file)) return "is a recording's own file, which no run writes: name another";
  const std::string ending = lower_case_ending(file);
  const auto thing = thing_of(ending);
  if (!thing || is_own_ending(ending, kind)) return std::nullopt;
  return fmt::format("ends in {} as a {} does, and what is written here is none: name another file", ending,
                     *thing);
}

std::optional<std::string> fault_of_replacing(const fs::path& output, OutputKind kind) {
  const auto thing = thing_of(lower_case_ending(written_file(output)));
  if (thing && thing != "bag") return "is a picture or video, which this would replace: name another file";
  if (is_bag(output)) {
    if (kind == OutputKind::kMcap && is_own_mcap(output)) return std::nullopt;
    return "is a bag, which this would replace: name another file";
  }
  const std::string start = start_of(output);
  if (!is_binary(start) || (kind == OutputKind::kGlb && start.starts_with("glTF"))) return std::nullopt;
  return "is a file of binary data, which this would replace: name another file";
}

bool has_picture_ending(const fs::path& path) {
  return has(kPictures, lower_case_ending(path));
}

bool is_part_of_bag(const fs::path& output, const std::string& input) {
  std::error_code ignored;
  if (!fs::is_directory(input, ignored) || !is_bag(input)) return false;
  const fs::path file = written_file(output);
  return fs::equivalent(file.parent_path(), input, ignored) &&
         (file.filename() == kMetadata || has(kBags, lower_case_ending(file)));
}

}  // namespace apriltrack::app
