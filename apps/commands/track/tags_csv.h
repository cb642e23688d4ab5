#pragma once

#include <filesystem>
#include <span>

#include "apriltrack/base/timestamp.h"
#include "apriltrack/io/growing_file.h"
#include "tag_sights.h"

namespace apriltrack::app {

/// `track --tags-csv`: a line for each frame and tag in view (docs/file_formats.md), written as frames are
/// done.
class TagsCsv {
 public:
  /// Throws Error(kIo).
  TagsCsv(StagedFiles& files, const std::filesystem::path& path);
  void add(Timestamp timestamp, std::span<const TagSight> sights);
  void close() { file_.close(); }

 private:
  GrowingFile file_;
};

}  // namespace apriltrack::app
