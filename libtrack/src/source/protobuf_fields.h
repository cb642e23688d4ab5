#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace apriltrack {

/// A field of a protobuf message: by its number, as its schema tells what it is.
struct ProtobufField {
  enum class Kind : std::uint8_t { kVarint = 0, kEight = 1, kBytes = 2, kFour = 5 };

  std::uint32_t number = 0;
  Kind kind = Kind::kVarint;
  std::uint64_t value = 0;  ///< Of a number, its bits.
  std::string_view bytes;   ///< Of text, bytes, messages and packed lists: a view of the message.
};

/// Reads a message field by field (https://protobuf.dev/programming-guides/encoding).
class ProtobufFields {
 public:
  explicit ProtobufFields(std::string_view message) : message_(message) {}
  /// nullopt at the end. Throws BadMessage where the bytes are no such message.
  std::optional<ProtobufField> next();

 private:
  std::uint64_t varint();
  std::string_view take(std::uint64_t size);

  std::string_view message_;  ///< What is left of it.
};

}  // namespace apriltrack
