#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "byte_buffer.h"
#include "random_access_file.h"

namespace apriltrack {

/// Looks through a file for what begins like a record. The bytes stay in memory from one search to the next:
/// in a damaged file each may end a few bytes on.
class SearchWindow {
 public:
  /// overlap: a record is found if so many of its bytes are looked at. file: outlives this.
  SearchWindow(const RandomAccessFile& file, std::uint64_t overlap) : file_(file), overlap_(overlap) {}

  /// The first place at or behind `from`. find: of (bytes, number of the file's bytes behind these), gives a
  /// place in them, or npos.
  template <class Find>
  std::optional<std::uint64_t> first(std::uint64_t from, const Find& find) {
    while (from < file_.size()) {
      const std::string_view bytes = from_on(from);
      const std::uint64_t behind = file_.size() - std::min(file_.size(), from + bytes.size());
      const std::size_t found = find(bytes, behind);
      if (found != std::string_view::npos) return from + found;
      from = begin_ + kStep;
    }
    return std::nullopt;
  }

 private:
  static constexpr std::uint64_t kStep = 1 << 20;

  std::string_view from_on(std::uint64_t from) {
    const bool is_there =
        from >= begin_ && from - begin_ < std::min<std::uint64_t>(kStep, bytes_.view().size());
    if (!is_there) {
      begin_ = from;
      file_.read(begin_, kStep + overlap_, bytes_);
    }
    return bytes_.view().substr(from - begin_);
  }

  const RandomAccessFile& file_;
  std::uint64_t overlap_;
  std::uint64_t begin_ = 0;
  ByteBuffer bytes_;
};

}  // namespace apriltrack
