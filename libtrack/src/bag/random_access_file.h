#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "byte_buffer.h"

namespace apriltrack {

/// A file that is read here and there. By pread and not by a mapping: as fast (bench/reports), and a file
/// that another program cuts meanwhile is a short read, not a signal that ends the process.
class RandomAccessFile {
 public:
  /// name: what messages call it. Throws Error(kIo) when it cannot be opened or is no regular file.
  RandomAccessFile(const std::filesystem::path& path, std::string name);
  explicit RandomAccessFile(const std::filesystem::path& path) : RandomAccessFile(path, path.string()) {}
  ~RandomAccessFile();
  RandomAccessFile(const RandomAccessFile&) = delete;
  RandomAccessFile& operator=(const RandomAccessFile&) = delete;

  const std::string& name() const { return name_; }
  /// When it was opened; what a recorder adds later is not read.
  std::uint64_t size() const { return size_; }
  /// At most `count` bytes from `offset` on, fewer where the file ends. Throws Error(kIo) where the disk
  /// fails.
  void read(std::uint64_t offset, std::uint64_t count, ByteBuffer& into) const;
  std::string read(std::uint64_t offset, std::uint64_t count) const;

 private:
  std::string name_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace apriltrack
