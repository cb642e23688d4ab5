#include "outputs.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <system_error>

#include "apriltrack/base/error.h"

namespace apriltrack::app {
namespace {

namespace fs = std::filesystem;

/// The files of a recording that no run may replace (docs/file_formats.md), whatever it is asked to write.
constexpr std::array<std::string_view, 4> kOwnFiles = {"camera.yaml", "map.yaml", "frames.csv", "truth.tum"};
constexpr std::array<std::string_view, 12> kPictures = {".png",  ".jpg", ".jpeg", ".bmp", ".tif", ".tiff",
                                                        ".webp", ".pgm", ".ppm",  ".mp4", ".avi", ".mkv"};

bool is_picture(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(kPictures.begin(), kPictures.end(), extension) != kPictures.end();
}

bool is_input(const fs::path& output, const fs::path& input) {
  std::error_code ignored;
  if (fs::equivalent(output, input, ignored)) return true;
  return std::any_of(kOwnFiles.begin(), kOwnFiles.end(),
                     [&](std::string_view name) { return fs::equivalent(output, input / name, ignored); });
}

}  // namespace

void check_output(const std::string& output, std::string_view option,
                  const std::vector<std::string>& inputs) {
  if (output.empty()) throw invalid_input(option, "is empty: name the file to write");
  const fs::path path = output;
  const fs::path folder = path.parent_path();
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) throw io_error(output, "is a folder: name a file in it");
  if (!folder.empty() && !fs::is_directory(folder, ignored))
    throw io_error(output, "cannot be written: there is no such folder");
  if (!fs::exists(path, ignored)) return;
  if (::access(path.c_str(), W_OK) != 0)
    throw io_error(output, fmt::format("cannot be written: {}", std::generic_category().message(errno)));
  const bool replaces_input = std::any_of(inputs.begin(), inputs.end(), [&](const std::string& input) {
    return !input.empty() && is_input(path, input);
  });
  if (replaces_input)
    throw invalid_input(option, fmt::format("'{}' is an input of this run: name another file", output));
  if (fs::is_regular_file(path, ignored) && is_picture(path))
    throw invalid_input(option,
                        fmt::format("'{}' is a picture or video, which this would replace: name another "
                                    "file",
                                    output));
}

OutputsTogether::~OutputsTogether() {
  for (const auto& [written, target] : pending_) {
    std::error_code ignored;
    fs::remove(written, ignored);
  }
}

fs::path OutputsTogether::aside(const fs::path& target) {
  std::error_code error;
  const fs::file_status status = fs::status(target, error);
  if (fs::exists(status) && !fs::is_regular_file(status)) return target;
  const fs::path file = fs::is_symlink(target) ? fs::weakly_canonical(target) : target;
  const fs::path written = file.string() + fmt::format(".{}.new", ::getpid());
  pending_.emplace_back(written, file);
  return written;
}

void OutputsTogether::put_in_place() {
  for (const auto& [written, target] : pending_) {
    std::error_code error;
    if (fs::exists(target, error)) fs::permissions(written, fs::status(target).permissions(), error);
    fs::rename(written, target, error);
    if (error) throw io_error(target.string(), fmt::format("cannot be written: {}", error.message()));
  }
  pending_.clear();
}

}  // namespace apriltrack::app
