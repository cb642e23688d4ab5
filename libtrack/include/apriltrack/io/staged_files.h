#pragma once

#include <filesystem>
#include <functional>
#include <vector>

namespace apriltrack {

/// The file that writing to `path` makes or replaces, whether or not it is there yet: absolute, and with all
/// links followed, so that two names of one file give the same. Throws Error(kIo) for links without end.
std::filesystem::path written_file(const std::filesystem::path& path);

/// What nothing can be written beside, to take its place: a device, a FIFO, /dev/stdout, /dev/fd/N.
bool is_written_directly(const std::filesystem::path& path);

/// Files that belong together: all are written aside first, and put in place when the last is complete, so
/// that a run which fails in between replaces none of them.
///
///   StagedFiles files;
///   files.write("camera.tum", [&](const auto& path) { write_tum(path, trajectory); });
///   files.write("frames.csv", [&](const auto& path) { write_frame_log(path, rows); });
///   files.commit();
class StagedFiles {
 public:
  StagedFiles() = default;
  /// Removes what was not put in place, and folders that were made for it.
  ~StagedFiles();
  StagedFiles(const StagedFiles&) = delete;
  StagedFiles& operator=(const StagedFiles&) = delete;

  /// Where to write what will become `target`: a name beside it, or beside what it links to; `target` itself
  /// where it is a device, a pipe or an open descriptor, which nothing can take the place of. Throws
  /// Error(kInvalidInput) when the same file is staged already, Error(kIo) for a chain of links without end.
  std::filesystem::path stage(const std::filesystem::path& target);

  /// Hands the place to write what will become `target` to `writer`. An Error about that place is told of
  /// `target`, the name that the user knows. Throws as stage() and the writer do.
  void write(const std::filesystem::path& target,
             const std::function<void(const std::filesystem::path& path)>& writer);

  /// Makes a folder for what is staged, and those that it is in, unless they are there; taken away again,
  /// where they are empty, unless commit() ends well. Throws Error(kIo).
  void make_folder(const std::filesystem::path& folder);

  /// Existing files keep their modes. Throws Error(kIo) that names the file, and leaves the remaining ones as
  /// they were.
  void commit();

 private:
  struct File {
    std::filesystem::path written;
    std::filesystem::path target;
    std::filesystem::path name;  ///< The target as its user calls it.
  };
  std::vector<File> files_;
  std::vector<std::filesystem::path> folders_;  ///< That were made, the inner ones first.
};

}  // namespace apriltrack
