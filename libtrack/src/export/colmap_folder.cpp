// What lies where a COLMAP model is to be written. Ours has no camera and no image, and points without a
// track; COLMAP's own points have one (src/colmap/scene/reconstruction_io.cc of colmap/colmap), and its
// readers take the binary files before the text.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "apriltrack/base/error.h"
#include "apriltrack/io/input_file.h"
#include "apriltrack/io/trimmed.h"
#include "writers.h"

namespace apriltrack {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 7> kNeverOurs = {
    "cameras.bin", "images.bin", "points3D.bin", "rigs.bin", "frames.bin", "rigs.txt", "frames.txt"};

/// Lines that are no comments, of the file's beginning: a model of somebody's shows there already.
std::vector<std::string> first_lines(const fs::path& path) {
  constexpr std::size_t kEnough = 1 << 16;
  std::string text(kEnough, ' ');
  text.resize(InputFile(path).read(0, text.data(), text.size()));
  if (text.size() == kEnough) text.resize(text.rfind('\n') + 1);  // the last line may be cut
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line(trimmed(std::string_view(text).substr(begin, end - begin)));
    if (!line.empty() && !line.starts_with('#')) lines.push_back(line);
    begin = end + 1;
  }
  return lines;
}

/// "12 0.5 -1 2 0 0 0 0": black, without an error, and no track behind it.
bool is_our_point(const std::string& line) {
  return std::ranges::count(line, ' ') == 7 && line.ends_with(" 0 0 0 0");
}

/// The first file that is somebody else's; empty where there is none.
std::string file_of_another(const fs::path& folder) {
  std::error_code ignored;
  for (const std::string_view name : kNeverOurs)
    if (fs::exists(folder / name, ignored)) return std::string(name);
  for (const char* name : {"cameras.txt", "images.txt", "points3D.txt"}) {
    if (!fs::exists(folder / name, ignored)) continue;
    const bool may_have_points = std::string_view(name) == "points3D.txt";
    const auto lines = first_lines(folder / name);
    if (!std::ranges::all_of(lines, [&](const auto& line) { return may_have_points && is_our_point(line); }))
      return name;
  }
  return "";
}

}  // namespace

void check_colmap_folder(const fs::path& folder) {
  const std::string name = file_of_another(folder);
  if (name.empty()) return;
  throw invalid_input(
      folder.string(),
      fmt::format("holds a COLMAP model ({}) that was not made of a tag map, and would lose its "
                  "cameras and images: name another folder",
                  name));
}

}  // namespace apriltrack
