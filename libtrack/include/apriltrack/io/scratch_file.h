#pragma once

#include <filesystem>

namespace apriltrack {

/// A file to work in, which is gone with its object, or with the process, however that ends.
class ScratchFile {
 public:
  /// place: in whose folder it is made, on the disk whose room it takes; where that cannot have files without
  /// a name, it is called `place` with an ending that no other process uses, and a killed process leaves it.
  /// Throws Error(kIo) about `place`.
  explicit ScratchFile(const std::filesystem::path& place);
  ~ScratchFile();
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  /// Of this process alone; may be opened any number of times.
  const std::filesystem::path& path() const { return path_; }
  int descriptor() const { return descriptor_; }

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
  bool has_name_ = false;
};

}  // namespace apriltrack
