#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "apriltrack/io/byte_order.h"

namespace apriltrack {

/// Appends little-endian fields, the counterpart of ByteCursor.
class ByteWriter {
 public:
  ByteWriter& u8(std::uint8_t value) { return number(value, 1); }
  ByteWriter& u16(std::uint16_t value) { return number(value, 2); }
  ByteWriter& u32(std::uint32_t value) { return number(value, 4); }
  ByteWriter& u64(std::uint64_t value) { return number(value, 8); }
  ByteWriter& raw(std::string_view bytes) {
    bytes_ += bytes;
    return *this;
  }
  /// Behind their own number, which has four bytes.
  ByteWriter& sized(std::string_view bytes) {
    return u32(static_cast<std::uint32_t>(bytes.size())).raw(bytes);
  }

  const std::string& bytes() const { return bytes_; }
  void clear() { bytes_.clear(); }

 private:
  ByteWriter& number(std::uint64_t value, std::size_t size) {
    append_little_endian(bytes_, value, size);
    return *this;
  }

  std::string bytes_;
};

}  // namespace apriltrack
