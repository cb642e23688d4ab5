#include "protobuf_fields.h"

#include <fmt/format.h>

#include "apriltrack/io/byte_order.h"
#include "ros_message.h"

namespace apriltrack {
namespace {

constexpr unsigned kKindBits = 3;

}  // namespace

std::optional<ProtobufField> ProtobufFields::next() {
  if (message_.empty()) return std::nullopt;
  const std::uint64_t tag = varint();
  ProtobufField field;
  if (tag >> kKindBits == 0 || tag >> 32 != 0) throw BadMessage("is no protobuf message");
  field.number = static_cast<std::uint32_t>(tag >> kKindBits);
  field.kind = static_cast<ProtobufField::Kind>(tag & ((1u << kKindBits) - 1));
  switch (field.kind) {
    case ProtobufField::Kind::kVarint:
      field.value = varint();
      return field;
    case ProtobufField::Kind::kEight:
      field.value = little_endian(take(8));
      return field;
    case ProtobufField::Kind::kFour:
      field.value = little_endian(take(4));
      return field;
    case ProtobufField::Kind::kBytes:
      field.bytes = take(varint());
      return field;
  }
  throw BadMessage(fmt::format("is no protobuf message that is read: field {} has wire type {}", field.number,
                               tag & ((1u << kKindBits) - 1)));
}

std::uint64_t ProtobufFields::varint() {
  constexpr unsigned kMostBits = 64, kBitsPerByte = 7;
  std::uint64_t value = 0;
  for (unsigned shift = 0; shift < kMostBits; shift += kBitsPerByte) {
    const auto byte = static_cast<unsigned char>(take(1).front());
    value |= std::uint64_t{byte & 0x7fu} << shift;
    if (byte < 0x80u) return value;
  }
  throw BadMessage("is no protobuf message: a number is longer than 64 bits");
}

std::string_view ProtobufFields::take(std::uint64_t size) {
  if (size > message_.size()) throw BadMessage("ends too soon");
  const std::string_view taken = message_.substr(0, size);
  message_.remove_prefix(size);
  return taken;
}

}  // namespace apriltrack
