#include "fuzz_input.h"

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <map>

namespace apriltrack::fuzz {
namespace fs = std::filesystem;
namespace {

struct InputFile {
  fs::path path;
  int descriptor = -1;
};

/// In memory where the system has a place for that.
InputFile make_file(const std::string& ending) {
  std::error_code ignored;
  const fs::path folder = fs::is_directory("/dev/shm", ignored) ? "/dev/shm" : fs::temp_directory_path();
  const fs::path path = folder / ("apriltrack_fuzz_" + std::to_string(::getpid()) + ending);
  const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  if (descriptor < 0) std::abort();
  return {path, descriptor};
}

class InputFiles {
 public:
  ~InputFiles() {
    for (const auto& [ending, file] : files_) ::unlink(file.path.c_str());
  }
  const InputFile& with_ending(const std::string& ending) {
    const auto found = files_.find(ending);
    return found != files_.end() ? found->second : files_.emplace(ending, make_file(ending)).first->second;
  }

 private:
  std::map<std::string, InputFile> files_;
};

}  // namespace

fs::path file_of(std::string_view bytes, const std::string& ending) {
  static InputFiles files;
  const InputFile& file = files.with_ending(ending);
  const bool is_written =
      ::ftruncate(file.descriptor, 0) == 0 &&
      ::pwrite(file.descriptor, bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size());
  if (!is_written) std::abort();
  return file.path;
}

}  // namespace apriltrack::fuzz
