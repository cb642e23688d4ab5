#pragma once

#include <filesystem>
#include <memory>

#include "apriltrack/bag/bag_reader.h"

namespace apriltrack {

inline constexpr std::string_view kSqliteMagic("SQLite format 3\0", 16);

/// A SQLite file of rosbag2: tables `topics` and `messages`. Messages that are packed by zstd, one by one,
/// are unpacked. path: to open it by; name: what messages call it. Throws Error(kIo) where it is damaged so
/// that nothing can be read, Error(kInvalidInput) where it is no bag.
std::unique_ptr<BagReader> sqlite_bag(const std::filesystem::path& path, const std::string& name);

}  // namespace apriltrack
