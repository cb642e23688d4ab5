#pragma once

#include <filesystem>
#include <vector>

namespace apriltrack {

/// Files that belong together: all are written aside first, and put in place when the last is complete, so
/// that a run which fails in between replaces none of them.
///
///   StagedFiles files;
///   write_tum(files.stage("camera.tum"), trajectory);
///   write_frame_log(files.stage("frames.csv"), rows);
///   files.commit();
class StagedFiles {
 public:
  StagedFiles() = default;
  /// Removes what was not put in place.
  ~StagedFiles();
  StagedFiles(const StagedFiles&) = delete;
  StagedFiles& operator=(const StagedFiles&) = delete;

  /// Where to write what will become `target`: a name beside it, or beside what it links to; `target` itself
  /// where it is a device, a pipe or an open descriptor, which nothing can take the place of. Throws
  /// Error(kInvalidInput) when the same file is staged already, Error(kIo) for a chain of links without end.
  std::filesystem::path stage(const std::filesystem::path& target);

  /// Existing files keep their modes. Throws Error(kIo) that names the file, and leaves the remaining ones as
  /// they were.
  void commit();

 private:
  struct File {
    std::filesystem::path written;
    std::filesystem::path target;
  };
  std::vector<File> files_;
};

}  // namespace apriltrack
