#include "rosbag2_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <system_error>
#include <tuple>
#include <utility>

#include "apriltrack/base/error.h"
#include "apriltrack/io/yaml_reader.h"

namespace apriltrack {
namespace {
namespace fs = std::filesystem;

constexpr const char* kMetadata = "metadata.yaml";
constexpr const char* kRoot = "rosbag2_bagfile_information";

bool has_bag_ending(const fs::path& path) {
  const std::string name = path.filename().string();
  constexpr std::array<std::string_view, 4> kEndings = {".db3", ".mcap", ".db3.zstd", ".mcap.zstd"};
  return std::ranges::any_of(kEndings, [&](std::string_view ending) { return name.ends_with(ending); });
}

/// "bag_10.mcap" behind "bag_9.mcap": recorders count their files without leading zeros.
std::vector<fs::path> files_by_name(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;  // what cannot be listed holds no bag
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (has_bag_ending(entry->path())) files.push_back(entry->path());
  std::ranges::sort(files, {}, [](const fs::path& path) {
    const std::string name = path.filename().string();
    return std::tuple(name.size(), name);
  });
  return files;
}

void check_storage(const YamlNode& root) {
  const auto storage = root.find("storage_identifier");
  if (!storage) return;
  const std::string name = storage->as_string();
  if (name != "sqlite3" && name != "mcap")
    storage->fail(
        fmt::format("'{}' is not read; sqlite3 and mcap are: convert it with `ros2 bag convert`", name));
}

/// Modes are seen from the files themselves; formats are named.
void check_compression(const YamlNode& root) {
  const auto format = root.find("compression_format");
  if (!format || format->is_null()) return;
  const std::string name = format->as_string();
  if (!name.empty() && name != "zstd")
    format->fail(fmt::format("'{}' is not read; zstd is: convert it with `ros2 bag convert`", name));
}

/// Old versions wrote the folder's name before the file's; a file that was packed later has one ending more.
std::optional<fs::path> found_in(const fs::path& folder, const std::string& relative) {
  const fs::path name = fs::path(relative).filename();
  std::error_code ignored;
  for (const fs::path& path : {folder / name, folder / (name.string() + ".zstd")})
    if (fs::exists(path, ignored)) return path;
  return std::nullopt;
}

/// What a recorder writes when it closes the bag.
struct Metadata {
  std::optional<YamlNode> root;
  std::string fault;  ///< Why there is none; else empty.
};

Metadata read_metadata(const fs::path& folder) {
  std::error_code ignored;
  if (!fs::is_regular_file(folder / kMetadata, ignored))
    return {{}, fmt::format("there is no {}", kMetadata)};
  try {
    YamlNode root = YamlNode::read_file(folder / kMetadata);
    if (root.is_null()) return {{}, fmt::format("{} is empty", kMetadata)};
    return {std::move(root), ""};
  } catch (const Error& error) {
    return {{}, fmt::format("{} cannot be read ({})", kMetadata, error.cause())};
  }
}

}  // namespace

bool is_rosbag2_folder(const fs::path& folder) {
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) return false;
  const Metadata metadata = read_metadata(folder);
  if (!metadata.fault.empty()) return !files_by_name(folder).empty();
  return metadata.root->is_map() && metadata.root->find(kRoot).has_value();
}

std::vector<fs::path> rosbag2_files(const fs::path& folder, const LogSink& log) {
  const Metadata metadata = read_metadata(folder);
  if (!metadata.fault.empty()) {
    std::vector<fs::path> files = files_by_name(folder);
    if (files.empty()) throw io_error(folder.string(), "holds no bag files");
    log(LogLevel::kWarning,
        fmt::format("{}: {}, as of a recording that was not closed: the {} bag files there are read",
                    folder.string(), metadata.fault, files.size()));
    return files;
  }
  const YamlNode root = metadata.root->at(kRoot);
  check_storage(root);
  check_compression(root);
  const YamlNode paths = root.at("relative_file_paths");
  std::vector<fs::path> files;
  for (const YamlNode& node : paths.items()) {
    if (const auto path = found_in(folder, node.as_string()))
      files.push_back(*path);
    else
      log(LogLevel::kWarning, fmt::format("{}: {} is not there", node.where(), node.as_string()));
  }
  if (files.empty())
    throw io_error(folder.string(), fmt::format("none of the files that its {} names is there", kMetadata));
  return files;
}

}  // namespace apriltrack
