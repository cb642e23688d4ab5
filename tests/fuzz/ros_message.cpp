// Pictures, cameras and poses of ROS messages. The first byte tells type and encoding.

#include "ros_message.h"

#include "fuzz_input.h"
#include "ros_pixels.h"

namespace apriltrack {
namespace {

struct MessageReader {
  const char* type;
  void (*read)(const BagTopic&, std::string_view);
};

/// In the order of their numbers in seeds.
constexpr MessageReader kReaders[] = {
    {"sensor_msgs/Image", [](const BagTopic& t, std::string_view b) { values_of(read_image_message(t, b)); }},
    {"sensor_msgs/CompressedImage",
     [](const BagTopic& t, std::string_view b) { values_of(read_compressed_image_message(t, b)); }},
    {"sensor_msgs/CameraInfo", [](const BagTopic& t, std::string_view b) { read_camera_info_message(t, b); }},
    {"geometry_msgs/PoseStamped", [](const BagTopic& t, std::string_view b) { read_pose_message(t, b); }},
    {"nav_msgs/Odometry", [](const BagTopic& t, std::string_view b) { read_pose_message(t, b); }},
    {"nav_msgs/Path", [](const BagTopic& t, std::string_view b) { read_path_message(t, b); }},
    {"tf2_msgs/TFMessage", [](const BagTopic& t, std::string_view b) { read_tf_message(t, b); }},
};

}  // namespace
}  // namespace apriltrack

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace apriltrack;
  if (size == 0) return 0;
  const MessageReader& reader = kReaders[data[0] / 2 % std::size(kReaders)];
  const BagTopic topic = {.name = "/t", .type = reader.type, .encoding = data[0] % 2 == 0 ? "ros1" : "cdr"};
  try {
    reader.read(topic, fuzz::text_of(data + 1, size - 1));
  } catch (const BadMessage&) {
  }
  return 0;
}
