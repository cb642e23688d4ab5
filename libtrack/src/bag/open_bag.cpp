#include <fmt/format.h>

#include <system_error>
#include <utility>

#include "apriltrack/bag/bag_reader.h"
#include "apriltrack/base/error.h"
#include "chunked_reader.h"
#include "joined_reader.h"
#include "mcap_file.h"
#include "packed_file.h"
#include "random_access_file.h"
#include "ros1_bag.h"
#include "rosbag2_folder.h"
#include "sqlite_bag.h"
#include "unpack.h"

namespace apriltrack {
namespace {
namespace fs = std::filesystem;

enum class BagKind { kNone, kRos1, kMcap, kSqlite, kPacked };

BagKind kind_of(std::string_view start) {
  if (start.starts_with(kRos1Magic)) return BagKind::kRos1;
  if (start.starts_with(kMcapFamily)) return BagKind::kMcap;
  if (start.starts_with(kSqliteMagic)) return BagKind::kSqlite;
  if (start.starts_with(kZstdMagic)) return BagKind::kPacked;
  return BagKind::kNone;
}

/// kept: what must live as long as the reader.
class KeepingReader : public BagReader {
 public:
  KeepingReader(std::unique_ptr<BagReader> reader, std::shared_ptr<const void> kept)
      : kept_(std::move(kept)), reader_(std::move(reader)) {}
  const std::vector<BagTopic>& topics() const override { return reader_->topics(); }
  void choose(const std::set<std::size_t>& topics) override { reader_->choose(topics); }
  std::size_t num_messages() const override { return reader_->num_messages(); }
  std::optional<BagMessage> next() override { return reader_->next(); }
  bool pass_over() override { return reader_->pass_over(); }
  std::optional<Timestamp> next_time() override { return reader_->next_time(); }
  std::string damage() const override { return reader_->damage(); }

 private:
  std::shared_ptr<const void> kept_;
  std::unique_ptr<BagReader> reader_;
};

std::unique_ptr<BagReader> open_file(const fs::path& path, const std::string& name, const LogSink& log);

std::unique_ptr<BagReader> open_packed(const fs::path& path, const LogSink& log) {
  auto file = unpacked_file(path, log);
  const fs::path unpacked = file->path();
  return std::make_unique<KeepingReader>(open_file(unpacked, path.string(), log), std::move(file));
}

std::unique_ptr<BagReader> open_file(const fs::path& path, const std::string& name, const LogSink& log) {
  auto file = std::make_shared<RandomAccessFile>(path, name);
  switch (kind_of(file->read(0, 64))) {
    case BagKind::kRos1:
      return chunked_reader(file, ros1_bag(file));
    case BagKind::kMcap:
      return chunked_reader(file, mcap_file(file));
    case BagKind::kSqlite:
      return sqlite_bag(path, name);
    case BagKind::kPacked:
      return open_packed(path, log);
    case BagKind::kNone:
      break;
  }
  throw io_error(name, "is no bag (ROS 1 bag, MCAP, SQLite file of rosbag2), or its beginning is damaged");
}

std::unique_ptr<BagReader> open_folder(const fs::path& folder, const LogSink& log) {
  std::vector<BagPart> parts;
  std::string fault;
  for (const fs::path& file : rosbag2_files(folder, log)) {
    try {
      parts.push_back({file.filename().string(), open_file(file, file.string(), log)});
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::kIo) throw;
      log(LogLevel::kWarning, fmt::format("{}; it is left out", error.what()));
      fault = error.what();
    }
  }
  if (parts.empty())
    throw io_error(folder.string(), fmt::format("none of its files can be read; the last: {}", fault));
  return joined_reader(std::move(parts));
}

}  // namespace

bool is_bag(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::is_directory(status)) return is_rosbag2_folder(path);
  if (!fs::is_regular_file(status)) return false;
  try {
    return kind_of(RandomAccessFile(path).read(0, 64)) != BagKind::kNone;
  } catch (const Error&) {
    return false;
  }
}

std::unique_ptr<BagReader> open_bag(const fs::path& path, const LogSink& log) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return open_folder(path, log);
  return open_file(path, path.string(), log);
}

}  // namespace apriltrack
