// Foxglove's messages with pictures, cameras and poses. The first byte tells type and encoding.

#include "foxglove_message.h"

#include "foxglove_picture.h"
#include "fuzz_input.h"
#include "ros_pixels.h"

namespace apriltrack {
namespace {

void read_message(unsigned type, const BagTopic& topic, std::string_view bytes) {
  PictureBytes storage;
  switch (type) {
    case 0:
      values_of(read_foxglove_raw_image(topic, bytes, storage));
      break;
    case 1:
      values_of(read_foxglove_compressed_image(topic, bytes, storage));
      break;
    case 2:
      read_foxglove_calibration(topic, bytes);
      break;
    case 3:
      read_foxglove_time(topic, bytes);
      break;
    default:
      read_foxglove_pose(bytes, "it");  // JSON, whatever the topic says
  }
}

}  // namespace
}  // namespace apriltrack

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace apriltrack;
  if (size == 0) return 0;
  const BagTopic topic = {.name = "/t", .encoding = data[0] % 2 == 0 ? "protobuf" : "json"};
  fuzz::reads([&] {
    try {
      read_message(data[0] / 2 % 5, topic, fuzz::text_of(data + 1, size - 1));
    } catch (const BadMessage&) {
    }
  });
  return 0;
}
