#include "apriltrack/source/frame_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <system_error>

#include "apriltrack/base/error.h"
#include "apriltrack/io/input_file.h"
#include "apriltrack/io/numbers.h"
#include "apriltrack/source/bag_input.h"
#include "image_inputs.h"
#include "image_names.h"
#include "pipe_input.h"
#include "video_source.h"

namespace apriltrack {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kCameraPrefix = "camera:";
constexpr std::string_view kDevicePrefix = "/dev/video";
constexpr int kMaxCameraNumber = 255;
// Frames are at least a microsecond apart, and nine million of them fit into 64 bits of nanoseconds.
constexpr double kMinRate_hz = 1e-3;
constexpr double kMaxRate_hz = 1e6;
constexpr int kMinBits = 8;
constexpr int kMaxBits = 16;

void check_options(const SourceOptions& options) {
  if (options.rate_hz && !(*options.rate_hz >= kMinRate_hz && *options.rate_hz <= kMaxRate_hz)) {
    throw invalid_input("--rate", fmt::format("must be in [{:g}, {:g}] frames a second (is {})", kMinRate_hz,
                                              kMaxRate_hz, *options.rate_hz));
  }
  if (options.bits && !(*options.bits >= kMinBits && *options.bits <= kMaxBits))
    throw invalid_input("--bits",
                        fmt::format("must be in [{}, {}] (is {})", kMinBits, kMaxBits, *options.bits));
  if (options.step < 1) throw invalid_input("--step", "must be at least 1 (is 0)");
}

std::unique_ptr<SkippableSource> open_camera(const std::string& input, std::string_view number_text) {
  const auto number = parse_integer(number_text);
  if (!number || *number < 0 || *number > kMaxCameraNumber) {
    throw invalid_input(input,
                        fmt::format("'{}' is no camera number: write camera:0 or /dev/video0", number_text));
  }
  if (input.starts_with(kDevicePrefix) && !path_exists(input)) throw io_error(input, "no such camera");
  return open_live_camera(static_cast<int>(*number), input);
}

std::unique_ptr<SkippableSource> list_source(const std::string& input, std::vector<ImageEntry> entries,
                                             const SourceOptions& options) {
  return std::make_unique<ImageListSource>(input, std::move(entries), options);
}

void refuse_topic(const std::string& input, const SourceOptions& options) {
  if (options.topic.empty()) return;
  throw invalid_input("--topic", fmt::format("is of a bag, and '{}' is none: leave it out", input));
}

std::unique_ptr<SkippableSource> open_folder(const std::string& input, const SourceOptions& options) {
  if (is_bag_input(input)) return open_bag_source(input, options);
  refuse_topic(input, options);
  if (is_sequence_folder(input))
    return list_source(input, list_sequence(input, options.rate_hz, options.log), options);
  if (const auto camera = find_euroc_camera(input, options.camera_name))
    return list_source(input, list_euroc_camera(*camera), options);
  return list_source(input, list_image_folder(input, options.rate_hz), options);
}

/// The first bytes of a file, if it can be read at all.
std::string read_start(const std::string& input) {
  std::array<char, 1024> bytes;
  return {bytes.data(), InputFile(input).read(0, bytes.data(), bytes.size())};
}

/// FFmpeg would "play" a text as a film of its letters.
bool is_text(const std::string& start) {
  const auto is_control = [](unsigned char c) { return c < ' ' && c != '\n' && c != '\r' && c != '\t'; };
  return std::find_if(start.begin(), start.end(), is_control) == start.end();
}

std::unique_ptr<SkippableSource> open_file(const std::string& input, const SourceOptions& options) {
  const std::string start = read_start(input);
  if (is_bag_input(input)) return open_bag_source(input, options);
  refuse_topic(input, options);
  if (has_image_ending(input)) return list_source(input, list_single_image(input), options);
  if (start.empty()) throw io_error(input, "the file is empty (0 bytes)");
  if (is_text(start)) throw io_error(input, "is a text file, neither an image nor a video");
  return open_video(input, options.rate_hz, options.log);
}

/// Standard input may be a file (`- < film.mp4`), which can be read again, unlike a pipe.
std::unique_ptr<SkippableSource> open_pipe(const std::string& input, const SourceOptions& options) {
  constexpr const char* kOpenInput = "/dev/stdin";
  if (input == kStandardInput && fs::is_regular_file(kOpenInput)) return open_file(kOpenInput, options);
  if (input == kStandardInput && ::isatty(STDIN_FILENO) != 0)
    throw io_error(input,
                   "is standard input, and nothing is sent there: send a video or pictures, as "
                   "`ffmpeg -i film.mp4 -c copy -f matroska - | apriltrack track - ...` does");
  refuse_topic(input, options);
  return open_video(input, options.rate_hz, options.log);
}

std::unique_ptr<SkippableSource> open_any(const std::string& input, const SourceOptions& options) {
  if (input.empty())
    throw invalid_input("INPUT", "is empty: name a folder, an image pattern, a video or camera:N");
  if (input.starts_with(kCameraPrefix))
    return open_camera(input, std::string_view(input).substr(kCameraPrefix.size()));
  if (input.starts_with(kDevicePrefix))
    return open_camera(input, std::string_view(input).substr(kDevicePrefix.size()));
  if (is_pipe_input(input)) return open_pipe(input, options);
  std::error_code error;
  const fs::file_status status = fs::status(input, error);
  if (fs::is_directory(status)) return open_folder(input, options);
  if (fs::exists(status)) return open_file(input, options);
  refuse_topic(input, options);
  if (is_glob(input)) return list_source(input, list_glob(input, options.rate_hz), options);
  if (status.type() == fs::file_type::not_found) throw io_error(input, "no such file or folder");
  throw io_error(input, fmt::format("cannot be read: {}", error.message()));
}

std::optional<fs::path> sequence_file(const std::string& input, const char* name) {
  const fs::path path = fs::path(input) / name;
  if (!is_sequence_folder(input) || !path_exists(path)) return std::nullopt;
  return path;
}

}  // namespace

Frame SourceFrame::frame(int camera_index) const {
  return {.image = pixels.view(),
          .timestamp = timestamp,
          .exposure_s = exposure_s,
          .gain = gain,
          .camera_index = camera_index};
}

std::unique_ptr<FrameSource> open_source(const std::string& input, const SourceOptions& options) {
  check_options(options);
  return std::make_unique<SampledSource>(open_any(input, options), options);
}

std::optional<fs::path> sequence_camera_file(const std::string& input) {
  return sequence_file(input, "camera.yaml");
}

std::optional<fs::path> sequence_map_file(const std::string& input) {
  return sequence_file(input, "map.yaml");
}

std::optional<fs::path> euroc_camera_file(const std::string& input, const std::string& camera_name) {
  if (input.empty() || is_sequence_folder(input)) return std::nullopt;
  const auto camera = find_euroc_camera(input, camera_name);
  if (!camera || !path_exists(*camera / "sensor.yaml")) return std::nullopt;
  return *camera / "sensor.yaml";
}

}  // namespace apriltrack
