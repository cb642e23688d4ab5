#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace apriltrack {

class StagedFiles;

/// A file that is written piece by piece while a run goes on, from its beginning to its end and never gone
/// back in, so that a pipe will do. It is put in place when the run commits `files`: what has its name
/// already is kept until then. Where the file system can, it has no name until it is closed, so that nothing
/// is left of it, however the program ends.
class GrowingFile {
 public:
  /// files: must outlive it. A device or a pipe is written to directly. Throws Error(kIo).
  GrowingFile(StagedFiles& files, const std::filesystem::path& path);
  ~GrowingFile();
  GrowingFile(const GrowingFile&) = delete;
  GrowingFile& operator=(const GrowingFile&) = delete;

  /// The path, as messages call it.
  const std::string& name() const { return name_; }
  std::uint64_t size() const { return size_; }

  /// Hands the bytes to the system: who reads a pipe has them. Throws Error(kIo).
  void write(std::string_view bytes);
  /// All is on the disk then. Throws Error(kIo).
  void close();

 private:
  [[noreturn]] void fail() const;

  std::string name_;
  std::filesystem::path place_;  ///< Its own, until `files` are committed.
  int descriptor_ = -1;
  bool is_nameless_ = false;
  std::uint64_t size_ = 0;
};

}  // namespace apriltrack
