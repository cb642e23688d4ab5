#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

namespace apriltrack {

/// A file on a disk that is open to be read, here and there.
///
/// The only door by which this project opens what it reads.
/// What is there is looked at before and after it is opened: a pipe without a writer holds nobody up, and no
/// device is woken.
class InputFile {
 public:
  /// name: what messages call it. Throws Error(kIo) when it cannot be opened, and where it is a folder, a
  /// pipe, a socket or a device, with that word.
  InputFile(const std::filesystem::path& path, std::string name);
  explicit InputFile(const std::filesystem::path& path) : InputFile(path, path.string()) {}
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  const std::string& name() const { return name_; }
  int descriptor() const { return descriptor_; }
  /// In bytes, when it was opened. Files of /proc have 0, and more to read.
  std::uint64_t size() const { return size_; }
  /// Reads `count` bytes from `offset` on, fewer where the file ends; returns how many. By pread and not by a
  /// mapping: a file that another program cuts meanwhile is a short read, not a signal that ends the process.
  /// Throws Error(kIo) where the disk fails.
  std::size_t read(std::uint64_t offset, char* into, std::size_t count) const;

 private:
  std::string name_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

/// What comes through a pipe, once and in order: a FIFO, a shell's <(...), or standard input.
class InputPipe {
 public:
  /// path: "-" is standard input. Waits until there are bytes, or a writer that sends none has gone. Throws
  /// Error(kIo) when it cannot be opened, is no pipe, or nothing comes for half a minute.
  explicit InputPipe(const std::filesystem::path& path);
  ~InputPipe();
  InputPipe(const InputPipe&) = delete;
  InputPipe& operator=(const InputPipe&) = delete;

  const std::string& name() const { return name_; }
  /// What there is, `count` bytes at most; waits for it, and returns 0 once the writer has closed the pipe.
  /// Throws Error(kIo) where it fails.
  std::size_t read(char* into, std::size_t count) const;

 private:
  std::string name_;
  int descriptor_ = -1;
};

/// A day of poses at 30 Hz in a text; of YAML and JSON the number of values is limited as well (yaml_tree.h).
inline constexpr std::uint64_t kMaxTextBytes = std::uint64_t{256} << 20;
/// The corners of an hour at 30 Hz with 100 tags in every frame; a table is up to five times as large in
/// memory.
inline constexpr std::uint64_t kMaxTableBytes = std::uint64_t{2} << 30;
/// Decoders count a picture's bytes by 31 bits.
inline constexpr std::uint64_t kMaxPictureBytes = INT32_MAX;

/// The whole content of a file, or of what comes through a pipe until its writer closes it: /dev/stdin, a
/// shell's <(...), a named pipe. Throws Error(kInvalidInput) beyond `max_bytes`, of a file before anything of
/// it is read; Error(kIo) as InputFile does, with the system's reason, and for a pipe through which nothing
/// comes, be it for half a minute.
std::string read_file(const std::filesystem::path& path, std::uint64_t max_bytes = kMaxTextBytes);

}  // namespace apriltrack
