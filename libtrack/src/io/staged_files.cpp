#include "apriltrack/io/staged_files.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "apriltrack/base/error.h"
#include "write_target.h"

namespace apriltrack {
namespace fs = std::filesystem;

fs::path written_file(const fs::path& path) {
  const fs::path target = fs::absolute(follow_links(path)).lexically_normal();
  std::error_code error;
  const fs::path folder = fs::weakly_canonical(target.parent_path(), error);
  return error ? target : folder / target.filename();
}

StagedFiles::~StagedFiles() {
  std::error_code ignored;
  for (const File& file : files_) fs::remove(file.written, ignored);
  for (const fs::path& folder : folders_) fs::remove(folder, ignored);
}

void StagedFiles::make_folder(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> missing;
  for (fs::path path = fs::absolute(folder).lexically_normal(); !path.empty() && !fs::exists(path, error);
       path = path.parent_path())
    if (path.has_filename()) missing.push_back(path);
  fs::create_directories(folder, error);
  folders_.insert(folders_.begin(), missing.begin(), missing.end());
  if (error) throw io_error(folder.string(), fmt::format("cannot be made: {}", error.message()));
}

fs::path StagedFiles::stage(const fs::path& path) {
  if (is_written_directly(path)) return path;
  const fs::path target = written_file(path);
  if (std::ranges::find(files_, target, &File::target) != files_.end())
    throw invalid_input(path.string(),
                        "two different things are to be written there: give each its own name");
  const fs::path written = target.string() + fmt::format(".{}.new", ::getpid());
  files_.push_back({written, target, path});
  return written;
}

void StagedFiles::write(const fs::path& target, const std::function<void(const fs::path& path)>& writer) {
  const fs::path place = stage(target);
  try {
    writer(place);
  } catch (const Error& error) {
    if (error.where() != place.string()) throw;
    throw Error(error.kind(), target.string(), error.cause());
  }
}

void StagedFiles::commit() {
  while (!files_.empty()) {
    const File file = files_.front();
    std::error_code error;
    const fs::file_status existing = fs::status(file.target, error);
    if (fs::exists(existing)) fs::permissions(file.written, existing.permissions(), error);
    fs::rename(file.written, file.target, error);
    if (!error && !sync_folder_of(file.target)) error = {errno, std::generic_category()};
    if (error) throw io_error(file.name.string(), fmt::format("cannot be written: {}", error.message()));
    files_.erase(files_.begin());
  }
  folders_.clear();
}

}  // namespace apriltrack
