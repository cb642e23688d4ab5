#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>

#include "apriltrack/io/input_file.h"
#include "byte_buffer.h"

namespace apriltrack {

/// A bag's file. What a recorder adds to it later is not read.
class RandomAccessFile {
 public:
  /// Throws as InputFile does.
  RandomAccessFile(const std::filesystem::path& path, std::string name) : file_(path, std::move(name)) {}
  explicit RandomAccessFile(const std::filesystem::path& path) : file_(path) {}

  const std::string& name() const { return file_.name(); }
  std::uint64_t size() const { return file_.size(); }
  /// At most `count` bytes from `offset` on, fewer where the file ends. Throws Error(kIo) where the disk
  /// fails.
  void read(std::uint64_t offset, std::uint64_t count, ByteBuffer& into) const;
  std::string read(std::uint64_t offset, std::uint64_t count) const;

 private:
  InputFile file_;
};

}  // namespace apriltrack
