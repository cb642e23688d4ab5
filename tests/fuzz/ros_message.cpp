// Pictures and cameras of ROS messages. The first byte tells type and encoding.

#include "ros_message.h"

#include "fuzz_input.h"
#include "ros_pixels.h"

namespace fuzz = apriltrack::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const apriltrack::BagTopic topic = {
      .name = "/t", .type = "sensor_msgs/Image", .encoding = data[0] % 2 == 0 ? "ros1" : "cdr"};
  const std::string_view bytes = fuzz::text_of(data + 1, size - 1);
  try {
    switch (data[0] / 2 % 3) {
      case 0:
        apriltrack::values_of(apriltrack::read_image_message(topic, bytes));
        break;
      case 1:
        apriltrack::values_of(apriltrack::read_compressed_image_message(topic, bytes));
        break;
      default:
        apriltrack::read_camera_info_message(topic, bytes);
    }
  } catch (const apriltrack::BadMessage&) {
  }
  return 0;
}
