#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string_view>

#include "apriltrack/io/byte_order.h"

namespace apriltrack {

/// Bytes that are not what the format says. Never leaves the module: it becomes damage, or an Error.
class BadBytes : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Reads little-endian fields one after the other. Throws BadBytes where they end too soon.
class ByteCursor {
 public:
  explicit ByteCursor(std::string_view bytes, std::size_t position = 0)
      : bytes_(bytes), position_(position) {}

  std::size_t position() const { return position_; }
  bool is_at_end() const { return position_ >= bytes_.size(); }

  std::string_view take(std::uint64_t size) {
    if (position_ > bytes_.size() || size > bytes_.size() - position_) throw BadBytes("a record is cut off");
    const std::string_view taken = bytes_.substr(position_, static_cast<std::size_t>(size));
    position_ += taken.size();
    return taken;
  }
  std::uint8_t u8() { return static_cast<std::uint8_t>(little_endian(take(1))); }
  std::uint16_t u16() { return static_cast<std::uint16_t>(little_endian(take(2))); }
  std::uint32_t u32() { return static_cast<std::uint32_t>(little_endian(take(4))); }
  std::uint64_t u64() { return little_endian(take(8)); }
  /// Bytes behind their own number, which has four bytes.
  std::string_view sized() { return take(u32()); }

 private:
  std::string_view bytes_;
  std::size_t position_;
};

}  // namespace apriltrack
