#pragma once

#include <algorithm>
#include <cstdint>
#include <string_view>
#include <vector>

#include "byte_cursor.h"
#include "chunk_layout.h"

namespace apriltrack {

/// Goes through all records of an unpacked chunk. take: reads the record at a cursor into the contents, or
/// throws BadBytes and leaves the contents as they are; it then goes on at the next hint, if there is one.
template <class Take>
ChunkContents walk_records(std::string_view unpacked, const std::vector<std::uint32_t>& hints,
                           const Take& take) {
  ChunkContents contents;
  std::size_t position = 0;
  while (position < unpacked.size()) {
    try {
      ByteCursor cursor(unpacked, position);
      take(cursor, contents);
      position = cursor.position();
    } catch (const BadBytes& bad) {
      if (contents.damage.empty()) contents.damage = bad.what();
      const auto next = std::upper_bound(hints.begin(), hints.end(), position);
      if (next == hints.end()) break;
      position = *next;
    }
  }
  return contents;
}

}  // namespace apriltrack
