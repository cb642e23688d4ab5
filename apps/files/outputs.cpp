#include "outputs.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>

#include "apriltrack/base/error.h"
#include "apriltrack/eval/trajectory_formats.h"
#include "apriltrack/io/staged_files.h"
#include "cli/console.h"

namespace apriltrack::app {
namespace {

namespace fs = std::filesystem;

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

void refuse(const std::string& output, std::string_view option, const std::optional<std::string>& fault) {
  if (fault) throw invalid_input(option, fmt::format("'{}' {}", output, *fault));
}

/// What a run reads is no place to write: its files, and the names that it would read as parts of a folder.
void refuse_input(const std::string& output, std::string_view option,
                  const std::vector<std::string>& inputs) {
  std::error_code ignored;
  for (const std::string& input : inputs) {
    if (fs::equivalent(output, input, ignored))
      refuse(output, option, "is an input of this run: name another file");
    if (is_part_of_bag(output, input))
      refuse(output, option,
             fmt::format("belongs to the bag '{}', an input of this run: name a file elsewhere", input));
  }
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

void check_output(const std::string& output, std::string_view option, const std::vector<std::string>& inputs,
                  OutputKind kind) {
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
  if (is_there && ::access(path.c_str(), W_OK) != 0)
    throw io_error(output, fmt::format("cannot be written: {}", std::generic_category().message(errno)));
  if (is_written_directly(path)) return;
  refuse_input(output, option, inputs);
  if (is_there) refuse(output, option, fault_of_replacing(path, kind));
  refuse(output, option, fault_of_name(path, kind));
}

void check_outputs(const std::vector<OutputFile>& outputs, const std::vector<std::string>& inputs) {
  for (auto output = outputs.begin(); output != outputs.end(); ++output) {
    if (output->name.empty()) continue;
    check_output(output->name, output->option, inputs, output->kind);
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
