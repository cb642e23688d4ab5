#include "outputs.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <filesystem>
#include <system_error>

#include "apriltrack/base/error.h"
#include "apriltrack/eval/trajectory_formats.h"
#include "apriltrack/io/staged_files.h"
#include "console.h"

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
constexpr std::array<std::string_view, 16> kPictures = {".png",  ".jpg", ".jpeg", ".bmp", ".tif", ".tiff",
                                                        ".webp", ".pgm", ".ppm",  ".pnm", ".mp4", ".m4v",
                                                        ".mov",  ".avi", ".mkv",  ".webm"};

bool is_picture(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(kPictures.begin(), kPictures.end(), extension) != kPictures.end();
}

/// A name that is not taken yet, too: a trajectory called frames.csv would be read as exposures ever after.
/// But a map of its own is what a recording that has none is calibrated for.
bool is_recordings_own(const fs::path& path) {
  std::error_code error;
  const fs::path file = written_file(path);
  if (file.filename() == "map.yaml" && !fs::exists(file, error)) return false;
  return std::ranges::any_of(kRecordingFiles, [&](const RecordingFile& own) {
    return file.filename() == own.name && fs::is_directory(file.parent_path() / own.images, error);
  });
}

/// Throws unless files can be made in the folder. Made and removed, because permissions do not tell: /proc
/// and disks mounted to be read refuse whom they seem to let in.
void check_writable(const fs::path& folder, const std::string& output) {
  const fs::path trial = folder / fmt::format(".apriltrack.{}.trial", ::getpid());
  const int descriptor = ::open(trial.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (descriptor < 0) {
    throw io_error(output, fmt::format("cannot be written: nothing can be made in '{}': {}", folder.string(),
                                       std::generic_category().message(errno)));
  }
  ::close(descriptor);
  ::unlink(trial.c_str());
}

void check_not_own(const std::string& output, std::string_view option) {
  if (!is_recordings_own(output)) return;
  throw invalid_input(
      option, fmt::format("'{}' is a recording's own file, which no run writes: name another", output));
}

/// A device or a pipe is no file that one output would take from the other.
bool is_same_file(const fs::path& a, const fs::path& b) {
  std::error_code ignored;  // check_output has said what is wrong with the names
  if (fs::exists(a, ignored) && !fs::is_regular_file(a, ignored)) return false;
  return written_file(a) == written_file(b);
}

/// By whatever name: /dev/stdout, /dev/fd/1, or the file that it is sent to.
bool is_stdout(const fs::path& path) {
  struct stat of_path {
  }, of_stdout{}, of_nothing{};
  if (::stat(path.c_str(), &of_path) != 0 || ::fstat(STDOUT_FILENO, &of_stdout) != 0) return false;
  const bool is_nothing = ::stat("/dev/null", &of_nothing) == 0 && of_nothing.st_rdev == of_path.st_rdev &&
                          S_ISCHR(of_path.st_mode);
  return !is_nothing && of_path.st_dev == of_stdout.st_dev && of_path.st_ino == of_stdout.st_ino;
}

}  // namespace

void check_output(const std::string& output, std::string_view option,
                  const std::vector<std::string>& inputs) {
  if (is_stdout(output)) leave_stdout_to_output();
  if (output.empty()) throw invalid_input(option, "is empty: name the file to write");
  const fs::path path = output;
  const fs::path folder = written_file(path).parent_path();
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) throw io_error(output, "is a folder: name a file in it");
  const bool is_there = fs::exists(path, ignored);
  if (!is_there && !fs::is_directory(folder, ignored))
    throw io_error(output, fmt::format("cannot be written: there is no folder '{}'", folder.string()));
  // What is no regular file, such as /dev/stdout, is written to as it is; others are written aside first.
  if (!is_there || fs::is_regular_file(path, ignored)) check_writable(folder, output);
  if (!is_there) return check_not_own(output, option);
  if (::access(path.c_str(), W_OK) != 0)
    throw io_error(output, fmt::format("cannot be written: {}", std::generic_category().message(errno)));
  const bool is_input = std::ranges::any_of(
      inputs, [&](const std::string& input) { return fs::equivalent(path, input, ignored); });
  if (is_input && fs::is_regular_file(path, ignored))
    throw invalid_input(option, fmt::format("'{}' is an input of this run: name another file", output));
  check_not_own(output, option);
  if (fs::is_regular_file(path, ignored) && is_picture(path))
    throw invalid_input(option,
                        fmt::format("'{}' is a picture or video, which this would replace: name another "
                                    "file",
                                    output));
}

void check_outputs(const std::vector<OutputFile>& outputs, const std::vector<std::string>& inputs) {
  for (auto output = outputs.begin(); output != outputs.end(); ++output) {
    if (output->name.empty()) continue;
    check_output(output->name, output->option, inputs);
    const auto same = std::find_if(outputs.begin(), output, [&](const OutputFile& earlier) {
      return !earlier.name.empty() && is_same_file(output->name, earlier.name);
    });
    if (same != output)
      throw invalid_input(output->option, fmt::format("is the file of {}: name another", same->option));
  }
}

std::string kitti_times_of(const std::string& output, std::string_view option) {
  if (is_written_directly(output))
    throw invalid_input(option, fmt::format("'{}' is no file that the times of KITTI's poses could stand "
                                            "beside: name a file, or choose another format",
                                            output));
  return kitti_times_file(output).string();
}

void check_output_folder(const std::string& output) {
  std::error_code ignored;
  fs::path there = fs::absolute(output).lexically_normal();
  while (!fs::exists(there, ignored) && there.has_relative_path()) there = there.parent_path();
  if (!fs::is_directory(there, ignored))
    throw io_error(output, fmt::format("cannot be made: '{}' is no folder", there.string()));
  check_writable(there, output);
}

}  // namespace apriltrack::app
