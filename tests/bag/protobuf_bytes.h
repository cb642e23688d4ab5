#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <vector>

namespace apriltrack::test {

// Fields of protobuf messages, byte by byte (https://protobuf.dev/programming-guides/encoding).

inline std::string varint(std::uint64_t value) {
  std::string bytes;
  for (; value >= 128; value >>= 7) bytes += static_cast<char>(value % 128 + 128);
  return bytes + static_cast<char>(value);
}
inline std::string fixed(std::uint64_t value, int size) {
  std::string bytes;
  for (int i = 0; i < size; ++i) bytes += static_cast<char>(value >> (8 * i) & 255);
  return bytes;
}
inline std::string varint_field(unsigned number, std::uint64_t value) {
  return varint(8 * number) + varint(value);
}
inline std::string fixed32_field(unsigned number, std::uint32_t value) {
  return varint(8 * number + 5) + fixed(value, 4);
}
inline std::string bytes_field(unsigned number, const std::string& bytes) {
  return varint(8 * number + 2) + varint(bytes.size()) + bytes;
}
inline std::string doubles_field(unsigned number, const std::vector<double>& values, bool is_packed = true) {
  std::string one_by_one, packed;
  for (const double value : values) {
    packed += fixed(std::bit_cast<std::uint64_t>(value), 8);
    one_by_one += varint(8 * number + 1) + fixed(std::bit_cast<std::uint64_t>(value), 8);
  }
  return is_packed ? bytes_field(number, packed) : one_by_one;
}
/// A google.protobuf.Timestamp as field 1.
inline std::string time_field(std::uint64_t seconds, std::uint64_t nanoseconds) {
  return bytes_field(1, varint_field(1, seconds) + varint_field(2, nanoseconds));
}

}  // namespace apriltrack::test
