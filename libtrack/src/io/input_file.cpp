#include "apriltrack/io/input_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <limits>
#include <utility>

#include "apriltrack/base/error.h"
#include "descriptor.h"

namespace apriltrack {
namespace fs = std::filesystem;
namespace {

constexpr int kPatience_ms = 30'000;  // a program on another machine may take its time to begin

Error told_by_system(const std::string& name, int code) {
  return io_error(name, fmt::format("cannot be read: {}", system_reason(code)));
}

bool is_pipe(const struct stat& found) {
  return S_ISFIFO(found.st_mode);
}

/// What is no file, by its name; empty for a file.
std::string_view other_than_file(const struct stat& found) {
  if (S_ISREG(found.st_mode)) return "";
  if (S_ISDIR(found.st_mode)) return "a folder";
  if (is_pipe(found)) return "a pipe";
  if (S_ISSOCK(found.st_mode)) return "a socket";
  return S_ISBLK(found.st_mode) ? "a disk" : "a device";
}

struct Opened {
  Descriptor descriptor;
  struct stat found {};
};

void refuse(const struct stat& found, const std::string& name, bool takes_pipe) {
  const std::string_view other = other_than_file(found);
  if (other.empty() || (takes_pipe && is_pipe(found))) return;
  throw io_error(name, fmt::format("cannot be read: it is {}, not a file{}", other,
                                   is_pipe(found) ? "; what comes through it must be in a file, for it is "
                                                    "read here and there"
                                                  : ""));
}

/// Asked before, lest opening a device does something; and of what was opened, which may be another thing.
Opened open_to_read(const fs::path& path, const std::string& name, bool takes_pipe) {
  struct stat found {};
  if (::stat(path.c_str(), &found) != 0) throw told_by_system(name, errno);
  refuse(found, name, takes_pipe);
  Opened opened{Descriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY))};
  if (opened.descriptor.get() < 0 || ::fstat(opened.descriptor.get(), &opened.found) != 0)
    throw told_by_system(name, errno);
  refuse(opened.found, name, takes_pipe);
  return opened;
}

/// Waits until a pipe has bytes, or its last writer has closed it.
void wait_for_bytes(int descriptor, const std::string& name) {
  struct pollfd watched = {descriptor, POLLIN, 0};
  int ready = 0;
  do ready = ::poll(&watched, 1, kPatience_ms);
  while (ready < 0 && errno == EINTR);
  if (ready < 0) throw told_by_system(name, errno);
  if (ready == 0)
    throw io_error(name,
                   fmt::format("cannot be read: nothing came through this pipe for {} s; does a program "
                               "write to it?",
                               kPatience_ms / 1000));
}

std::size_t read_some(int descriptor, char* into, std::size_t count, const std::string& name) {
  for (;;) {
    const ssize_t got = ::read(descriptor, into, count);
    if (got >= 0) return static_cast<std::size_t>(got);
    if (errno == EAGAIN)
      wait_for_bytes(descriptor, name);
    else if (errno != EINTR)
      throw told_by_system(name, errno);
  }
}

[[noreturn]] void fail_as_too_large(const std::string& name, std::uint64_t max_bytes) {
  throw invalid_input(name, fmt::format("is too large for what it is to be: at most {} MB are read",
                                        (max_bytes + (1 << 20) - 1) >> 20));
}

}  // namespace

InputFile::InputFile(const fs::path& path, std::string name) : name_(std::move(name)) {
  Opened opened = open_to_read(path, name_, false);
  size_ = static_cast<std::uint64_t>(opened.found.st_size);
  descriptor_ = opened.descriptor.release();
}

InputFile::~InputFile() {
  ::close(descriptor_);
}

std::size_t InputFile::read(std::uint64_t offset, char* into, std::size_t count) const {
  std::size_t done = 0;
  while (done < count && offset <= static_cast<std::uint64_t>(std::numeric_limits<off_t>::max()) - done) {
    const ssize_t got = ::pread(descriptor_, into + done, count - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw told_by_system(name_, errno);
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  return done;
}

InputPipe::InputPipe(const fs::path& path) : name_(path.string()) {
  const fs::path opened_by = name_ == "-" ? fs::path("/dev/stdin") : path;
  Opened opened = open_to_read(opened_by, name_, true);
  if (!is_pipe(opened.found)) throw io_error(name_, "cannot be read as a pipe: it is a file");
  wait_for_bytes(opened.descriptor.get(), name_);
  ::fcntl(opened.descriptor.get(), F_SETFL, 0);  // from now on a silent writer may take its time
  descriptor_ = opened.descriptor.release();
}

InputPipe::~InputPipe() {
  ::close(descriptor_);
}

std::size_t InputPipe::read(char* into, std::size_t count) const {
  return read_some(descriptor_, into, count, name_);
}

std::string read_file(const fs::path& path, std::uint64_t max_bytes) {
  const std::string name = path.string();
  const Opened opened = open_to_read(path, name, true);
  const int descriptor = opened.descriptor.get();
  if (static_cast<std::uint64_t>(std::max<off_t>(0, opened.found.st_size)) > max_bytes)
    fail_as_too_large(name, max_bytes);
  if (is_pipe(opened.found)) wait_for_bytes(descriptor, name);
  std::string contents;
  contents.reserve(static_cast<std::size_t>(std::max<off_t>(0, opened.found.st_size)));
  std::array<char, 1 << 16> block;
  for (;;) {
    const std::size_t count = read_some(descriptor, block.data(), block.size(), name);
    if (count == 0) break;
    if (contents.size() + count > max_bytes) fail_as_too_large(name, max_bytes);
    contents.append(block.data(), count);
  }
  if (contents.empty() && is_pipe(opened.found))
    throw io_error(name,
                   "cannot be read: nothing came through this pipe, or it was read before: what is read "
                   "twice must be a file");
  return contents;
}

}  // namespace apriltrack
