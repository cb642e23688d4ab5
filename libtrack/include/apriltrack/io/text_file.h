#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "apriltrack/io/input_file.h"

namespace apriltrack {

/// What some editors put before a text to say that it is UTF-8.
inline constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

/// read_file() without a byte order mark.
inline std::string read_text_file(const std::filesystem::path& path,
                                  std::uint64_t max_bytes = kMaxTextBytes) {
  std::string text = read_file(path, max_bytes);
  if (text.starts_with(kByteOrderMark)) text.erase(0, kByteOrderMark.size());
  return text;
}

}  // namespace apriltrack
