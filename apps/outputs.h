#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace apriltrack::app {

/// What can be wrong with a file to write, said before the work and not after it. option: "--output".
/// inputs: files and folders that this run reads; empty names are passed over. Throws Error(kInvalidInput)
/// when the name is empty, or that of an input, of a recording's own file or of a picture; Error(kIo) when it
/// is a folder's, its folder is missing, or the file may not be written.
void check_output(const std::string& output, std::string_view option, const std::vector<std::string>& inputs);

/// Files that one run writes and that belong together: all are written aside first, and put in place when the
/// last is complete, so that a run that fails in between replaces none of them.
class OutputsTogether {
 public:
  OutputsTogether() = default;
  ~OutputsTogether();
  OutputsTogether(const OutputsTogether&) = delete;
  OutputsTogether& operator=(const OutputsTogether&) = delete;

  /// Where to write what will become `target`: a name beside it, or `target` itself where that is a device or
  /// a pipe, which cannot be renamed to.
  std::filesystem::path aside(const std::filesystem::path& target);
  /// Throws Error(kIo) that names the file.
  void put_in_place();

 private:
  std::vector<std::pair<std::filesystem::path, std::filesystem::path>> pending_;  ///< Written, target.
};

}  // namespace apriltrack::app
