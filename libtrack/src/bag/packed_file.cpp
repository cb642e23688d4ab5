#include "packed_file.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zstd.h>

#include <algorithm>
#include <cerrno>
#include <map>
#include <mutex>
#include <system_error>
#include <tuple>
#include <vector>

#include "apriltrack/bag/bag_reader.h"
#include "apriltrack/base/error.h"
#include "random_access_file.h"

namespace apriltrack {
namespace {
namespace fs = std::filesystem;

void write_all(int descriptor, const char* bytes, std::size_t count, const std::string& name) {
  while (count > 0) {
    const ssize_t done = ::write(descriptor, bytes, count);
    if (done < 0 && errno == EINTR) continue;
    if (done < 0)
      throw io_error(name,
                     fmt::format("cannot be unpacked into the folder for temporary files: {} (TMPDIR names "
                                 "another one)",
                                 std::generic_category().message(errno)));
    bytes += done;
    count -= static_cast<std::size_t>(done);
  }
}

/// Returns what is wrong, empty when all is well.
std::string unpack_into(const RandomAccessFile& packed, int descriptor) {
  constexpr std::uint64_t kPiece = 1 << 20;
  const std::unique_ptr<ZSTD_DCtx, std::size_t (*)(ZSTD_DCtx*)> context(ZSTD_createDCtx(), ZSTD_freeDCtx);
  ByteBuffer input_buffer, output_buffer;
  output_buffer.reserve(4 * kPiece);
  std::size_t left = 1;
  for (std::uint64_t offset = 0; offset < packed.size(); offset += kPiece) {
    packed.read(offset, kPiece, input_buffer);
    ZSTD_inBuffer input = {input_buffer.data(), input_buffer.size(), 0};
    bool may_have_more = true;
    while (input.pos < input.size || may_have_more) {
      ZSTD_outBuffer output = {output_buffer.data(), output_buffer.capacity(), 0};
      left = ZSTD_decompressStream(context.get(), &output, &input);
      if (ZSTD_isError(left)) return fmt::format("its zstd bytes are damaged ({})", ZSTD_getErrorName(left));
      write_all(descriptor, output_buffer.data(), output.pos, packed.name());
      may_have_more = output.pos == output.size;
    }
  }
  return left == 0 ? "" : "it is cut off";
}

/// In the folder for temporary files.
std::shared_ptr<const ScratchFile> new_scratch_file() {
  std::error_code error;
  const fs::path folder = fs::temp_directory_path(error);
  if (error) throw io_error("TMPDIR", fmt::format("is no folder for temporary files: {}", error.message()));
  try {
    return std::make_shared<ScratchFile>(folder / "apriltrack_unpacked");
  } catch (const Error& failure) {
    throw io_error(
        folder.string(),
        fmt::format("nothing can be unpacked there ({}); TMPDIR names another folder", failure.cause()));
  }
}

std::shared_ptr<const ScratchFile> unpack_anew(const fs::path& path, const LogSink& log) {
  const RandomAccessFile packed(path);
  log(LogLevel::kInfo, fmt::format("{}: is unpacked into a temporary file", path.string()));
  const auto file = new_scratch_file();
  const std::string fault = unpack_into(packed, file->descriptor());
  struct stat found {};
  const bool is_empty = ::fstat(file->descriptor(), &found) != 0 || found.st_size == 0;
  if (is_empty)
    throw io_error(path.string(),
                   fmt::format("cannot be unpacked: {}", fault.empty() ? "it is empty" : fault));
  if (!fault.empty())
    log(LogLevel::kWarning, fmt::format("{}: {}; the first {} bytes of its content are read", path.string(),
                                        fault, found.st_size));
  return file;
}

using Identity = std::tuple<dev_t, ino_t, off_t, std::int64_t, std::int64_t>;

Identity identity_of(const InputFile& file) {
  struct stat found {};
  if (::fstat(file.descriptor(), &found) != 0)
    throw io_error(file.name(), fmt::format("cannot be read: {}", std::generic_category().message(errno)));
  return {found.st_dev, found.st_ino, found.st_size, found.st_mtim.tv_sec, found.st_mtim.tv_nsec};
}

/// Of this process.
struct UnpackedFiles {
  std::mutex mutex;
  std::map<Identity, std::weak_ptr<const ScratchFile>> known;
  std::size_t num_keepers = 0;
  std::vector<std::shared_ptr<const ScratchFile>> kept;
};

UnpackedFiles& unpacked_files() {
  static UnpackedFiles files;
  return files;
}

}  // namespace

UnpackedBags::UnpackedBags() {
  UnpackedFiles& files = unpacked_files();
  const std::lock_guard lock(files.mutex);
  ++files.num_keepers;
}

UnpackedBags::~UnpackedBags() {
  UnpackedFiles& files = unpacked_files();
  const std::lock_guard lock(files.mutex);
  if (--files.num_keepers == 0) files.kept.clear();
}

std::shared_ptr<const ScratchFile> unpacked_file(const fs::path& path, const LogSink& log) {
  const Identity identity = identity_of(InputFile(path));
  UnpackedFiles& files = unpacked_files();
  const std::lock_guard lock(files.mutex);
  std::erase_if(files.known, [](const auto& entry) { return entry.second.expired(); });
  if (auto file = files.known[identity].lock()) return file;
  auto file = unpack_anew(path, log);
  files.known[identity] = file;
  if (files.num_keepers > 0) files.kept.push_back(file);
  return file;
}

}  // namespace apriltrack
