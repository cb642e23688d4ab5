#include "foxglove_picture.h"

#include <fmt/format.h>

#include <bit>
#include <functional>
#include <initializer_list>
#include <limits>
#include <utility>

#include "apriltrack/base/error.h"
#include "apriltrack/io/base64.h"
#include "apriltrack/io/byte_order.h"
#include "apriltrack/io/yaml_reader.h"
#include "foxglove_message.h"
#include "protobuf_fields.h"

namespace apriltrack {
namespace {

constexpr std::size_t kSizeOfK = 9, kSizeOfP = 12;

bool is_json(const BagTopic& topic) {
  return topic.encoding == "json";
}

// JSON.

/// What `read` makes of the message; what is wrong with it is the message's fault.
template <class Read>
auto read_json(std::string_view bytes, const Read& read) {
  try {
    return read(YamlNode::read_json_text(std::string(bytes), "it"));
  } catch (const Error& error) {
    throw BadMessage(error.what());
  }
}

PictureBytes read_picture_bytes(const YamlNode& data, const YamlNode& format) {
  auto bytes = bytes_of_base64(data.as_string());
  if (!bytes) throw BadMessage("data: is not base64");
  return {*std::move(bytes), format.as_string()};
}

std::uint32_t read_count(const YamlNode& node) {
  const int value = node.as_int();
  if (value < 0) node.fail(fmt::format("must be >= 0 (is {})", value));
  return static_cast<std::uint32_t>(value);
}

// Protobuf. proto3 leaves out what is zero or empty.

void check_kind(const ProtobufField& field, ProtobufField::Kind kind) {
  if (field.kind != kind) throw BadMessage(fmt::format("field {}: is of another type", field.number));
}

/// google.protobuf.Timestamp
Timestamp time_of(std::string_view message) {
  std::int64_t seconds = 0, nanoseconds = 0;
  ProtobufFields fields(message);
  while (const auto field = fields.next()) {
    if (field->number != 1 && field->number != 2) continue;
    check_kind(*field, ProtobufField::Kind::kVarint);
    (field->number == 1 ? seconds : nanoseconds) = static_cast<std::int64_t>(field->value);
  }
  constexpr std::int64_t kMostSeconds = std::numeric_limits<std::int64_t>::max() / kNsPerSecond - 1;
  if (seconds < -kMostSeconds || seconds > kMostSeconds || nanoseconds < 0 || nanoseconds >= kNsPerSecond)
    throw BadMessage(
        fmt::format("timestamp: {} s and {} ns are no time in 64 bits of ns", seconds, nanoseconds));
  return {kNsPerSecond * seconds + nanoseconds};
}

/// Of a list of doubles: packed, as proto3 writes it, or one by one.
void add_doubles(const ProtobufField& field, std::vector<double>& values) {
  if (field.kind == ProtobufField::Kind::kEight) {
    values.push_back(std::bit_cast<double>(field.value));
    return;
  }
  check_kind(field, ProtobufField::Kind::kBytes);
  if (field.bytes.size() % sizeof(double) != 0) throw BadMessage("a list of numbers ends too soon");
  for (std::size_t at = 0; at < field.bytes.size(); at += sizeof(double))
    values.push_back(std::bit_cast<double>(little_endian(field.bytes.substr(at, sizeof(double)))));
}

void set(Timestamp& value, const ProtobufField& field) {
  check_kind(field, ProtobufField::Kind::kBytes);
  value = time_of(field.bytes);
}

void set(std::uint32_t& value, const ProtobufField& field) {
  if (field.kind == ProtobufField::Kind::kBytes) check_kind(field, ProtobufField::Kind::kFour);
  if (field.value > std::numeric_limits<std::uint32_t>::max())
    throw BadMessage(fmt::format("field {}: {} is beyond 32 bits", field.number, field.value));
  value = static_cast<std::uint32_t>(field.value);
}

void set(std::string_view& value, const ProtobufField& field) {
  check_kind(field, ProtobufField::Kind::kBytes);
  value = field.bytes;
}

void set(std::string& value, const ProtobufField& field) {
  check_kind(field, ProtobufField::Kind::kBytes);
  value = field.bytes;
}

void set(std::vector<double>& values, const ProtobufField& field) {
  add_doubles(field, values);
}

/// Where a message's field goes.
struct FieldTarget {
  std::uint32_t number;
  std::function<void(const ProtobufField&)> set_it;

  template <class Value>
  FieldTarget(std::uint32_t number_in_schema, Value& value)
      : number(number_in_schema), set_it([&value](const ProtobufField& field) { set(value, field); }) {}
};

/// Fields that have no target are skipped.
void read_fields(std::string_view message, std::initializer_list<FieldTarget> targets) {
  ProtobufFields fields(message);
  while (const auto field = fields.next())
    for (const FieldTarget& target : targets)
      if (target.number == field->number) target.set_it(*field);
}

RosImage raw_image_of(std::string_view message) {
  RosImage image;
  read_fields(message, {{1, image.stamp},
                        {2, image.width},
                        {3, image.height},
                        {4, image.encoding},
                        {5, image.step},
                        {6, image.data}});
  return image;
}

RosCompressedImage compressed_image_of(std::string_view message) {
  RosCompressedImage image;
  read_fields(message, {{1, image.stamp}, {2, image.data}, {3, image.format}});
  return image;
}

RosCameraInfo calibration_of(std::string_view message) {
  RosCameraInfo info;
  read_fields(
      message,
      {{2, info.width}, {3, info.height}, {4, info.distortion_model}, {5, info.d}, {6, info.k}, {8, info.p}});
  return info;
}

RosCameraInfo calibration_of(const YamlNode& message) {
  return {.height = read_count(message.at("height")),
          .width = read_count(message.at("width")),
          .distortion_model = message.at("distortion_model").as_string(),
          .d = message.at("D").as_doubles(),
          .k = message.at("K").as_doubles(),
          .p = message.at("P").as_doubles()};
}

/// An empty matrix is one that nobody filled in.
void check_matrix(std::vector<double>& matrix, std::size_t size, const char* name) {
  if (matrix.empty()) matrix.resize(size, 0.0);
  if (matrix.size() != size)
    throw BadMessage(fmt::format("{}: must have {} numbers (has {})", name, size, matrix.size()));
}

}  // namespace

bool is_read_foxglove_encoding(std::string_view encoding) {
  return encoding == "protobuf" || encoding == "json";
}

RosImage read_foxglove_raw_image(const BagTopic& topic, std::string_view bytes, PictureBytes& storage) {
  if (!is_json(topic)) return raw_image_of(bytes);
  return read_json(bytes, [&](const YamlNode& message) {
    storage = read_picture_bytes(message.at("data"), message.at("encoding"));
    return RosImage{.stamp = read_foxglove_time(message.at("timestamp")),
                    .height = read_count(message.at("height")),
                    .width = read_count(message.at("width")),
                    .encoding = storage.format,
                    .step = read_count(message.at("step")),
                    .data = storage.data};
  });
}

RosCompressedImage read_foxglove_compressed_image(const BagTopic& topic, std::string_view bytes,
                                                  PictureBytes& storage) {
  if (!is_json(topic)) return compressed_image_of(bytes);
  return read_json(bytes, [&](const YamlNode& message) {
    storage = read_picture_bytes(message.at("data"), message.at("format"));
    return RosCompressedImage{
        .stamp = read_foxglove_time(message.at("timestamp")), .format = storage.format, .data = storage.data};
  });
}

RosCameraInfo read_foxglove_calibration(const BagTopic& topic, std::string_view bytes) {
  RosCameraInfo info = is_json(topic) ? read_json(bytes, [](const YamlNode& m) { return calibration_of(m); })
                                      : calibration_of(bytes);
  check_matrix(info.k, kSizeOfK, "K");
  check_matrix(info.p, kSizeOfP, "P");
  return info;
}

Timestamp read_foxglove_time(const BagTopic& topic, std::string_view bytes) {
  if (is_json(topic))
    return read_json(bytes, [](const YamlNode& m) { return read_foxglove_time(m.at("timestamp")); });
  Timestamp stamp{};
  read_fields(bytes, {{1, stamp}});
  return stamp;
}

}  // namespace apriltrack
