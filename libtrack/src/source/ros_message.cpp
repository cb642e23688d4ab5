#include "ros_message.h"

#include <fmt/format.h>

#include <bit>
#include <cstddef>

#include "apriltrack/io/byte_order.h"

namespace apriltrack {
namespace {

/// Reads the fields of a message one after the other, as ROS 1 serialises them (little-endian, packed) or as
/// CDR does (OMG DDS-XTypes 1.3, section 7.4, encoding version 1: either byte order, numbers aligned to their
/// size, counted from behind the four bytes that tell the encoding; strings end with a zero).
class MessageFields {
 public:
  MessageFields(const BagTopic& topic, std::string_view bytes)
      : bytes_(bytes), is_cdr_(topic.encoding == "cdr") {
    if (is_cdr_) read_encapsulation();
  }

  bool is_cdr() const { return is_cdr_; }

  template <class T>
  T number() {
    align(sizeof(T));
    const std::string_view taken = take(sizeof(T));
    return static_cast<T>(is_big_endian_ ? big_endian(taken) : little_endian(taken));
  }
  double real() { return std::bit_cast<double>(number<std::uint64_t>()); }

  std::string_view text() {
    const auto size = number<std::uint32_t>();
    std::string_view text = take(size);
    if (is_cdr_ && text.ends_with('\0')) text.remove_suffix(1);
    return text;
  }
  std::string_view bytes() {
    const auto size = number<std::uint32_t>();
    return take(size);
  }
  std::vector<double> reals(std::size_t count) {
    std::vector<double> values;
    for (std::size_t i = 0; i < count; ++i) values.push_back(real());
    return values;
  }
  std::vector<double> reals() {
    const auto count = number<std::uint32_t>();
    if (count > bytes_.size() / sizeof(double)) throw BadMessage("ends too soon");
    return reals(count);
  }

 private:
  void read_encapsulation() {
    const std::string_view header = take(4);
    if (header[0] != 0 || (header[1] != 0 && header[1] != 1))
      throw BadMessage(fmt::format("is CDR of an encoding that is not read ({:02x}{:02x}; 0000 and 0001 are)",
                                   static_cast<unsigned char>(header[0]),
                                   static_cast<unsigned char>(header[1])));
    is_big_endian_ = header[1] == 0;
    start_ = position_;
  }

  void align(std::size_t size) {
    if (!is_cdr_) return;
    const std::size_t over = (position_ - start_) % size;
    if (over != 0) take(size - over);
  }

  std::string_view take(std::size_t size) {
    if (size > bytes_.size() - position_) throw BadMessage("ends too soon");
    const std::string_view taken = bytes_.substr(position_, size);
    position_ += size;
    return taken;
  }

  std::string_view bytes_;
  bool is_cdr_;
  bool is_big_endian_ = false;
  std::size_t position_ = 0;
  std::size_t start_ = 0;
};

struct RosHeader {
  Timestamp stamp;
  std::string_view frame_id;
};

/// std_msgs/Header: that of ROS 1 begins with a number; its seconds have no sign.
RosHeader take_whole_header(MessageFields& fields) {
  if (!fields.is_cdr()) fields.number<std::uint32_t>();
  const auto seconds = fields.number<std::uint32_t>();
  const std::int64_t signed_seconds =
      fields.is_cdr() ? std::int64_t{std::bit_cast<std::int32_t>(seconds)} : seconds;
  const std::int64_t nanoseconds = fields.number<std::uint32_t>();
  return {{signed_seconds * kNsPerSecond + nanoseconds}, fields.text()};
}

Timestamp take_header(MessageFields& fields) {
  return take_whole_header(fields).stamp;
}

/// Position and quaternion, as geometry_msgs/Pose and geometry_msgs/Transform have them.
RosPose take_pose(MessageFields& fields, Timestamp stamp) {
  RosPose pose;
  pose.stamp = stamp;
  for (Eigen::Index i = 0; i < 3; ++i) pose.position[i] = fields.real();
  for (Eigen::Index i = 0; i < 4; ++i)
    pose.orientation.coeffs()[i] = fields.real();  // x y z w, as Eigen has them
  return pose;
}

std::string without_slash(std::string_view frame) {
  if (frame.starts_with('/')) frame.remove_prefix(1);
  return std::string(frame);
}

}  // namespace

std::string short_type(std::string_view type) {
  constexpr std::string_view kMiddle = "/msg/";
  const std::size_t at = type.find(kMiddle);
  if (at == std::string_view::npos) return std::string(type);
  return std::string(type.substr(0, at)) + "/" + std::string(type.substr(at + kMiddle.size()));
}

bool is_read_encoding(std::string_view encoding) {
  return encoding == "ros1" || encoding == "cdr";
}

RosImage read_image_message(const BagTopic& topic, std::string_view bytes) {
  MessageFields fields(topic, bytes);
  RosImage image;
  image.stamp = take_header(fields);
  image.height = fields.number<std::uint32_t>();
  image.width = fields.number<std::uint32_t>();
  image.encoding = fields.text();
  image.is_big_endian = fields.number<std::uint8_t>() != 0;
  image.step = fields.number<std::uint32_t>();
  image.data = fields.bytes();
  return image;
}

RosCompressedImage read_compressed_image_message(const BagTopic& topic, std::string_view bytes) {
  MessageFields fields(topic, bytes);
  RosCompressedImage image;
  image.stamp = take_header(fields);
  image.format = fields.text();
  image.data = fields.bytes();
  return image;
}

RosCameraInfo read_camera_info_message(const BagTopic& topic, std::string_view bytes) {
  MessageFields fields(topic, bytes);
  RosCameraInfo info;
  take_header(fields);
  info.height = fields.number<std::uint32_t>();
  info.width = fields.number<std::uint32_t>();
  info.distortion_model = fields.text();
  info.d = fields.reals();
  info.k = fields.reals(9);
  fields.reals(9);  // R, the rectifying rotation
  info.p = fields.reals(12);
  info.binning_x = fields.number<std::uint32_t>();
  info.binning_y = fields.number<std::uint32_t>();
  info.roi_x = fields.number<std::uint32_t>();
  info.roi_y = fields.number<std::uint32_t>();
  info.roi_height = fields.number<std::uint32_t>();
  info.roi_width = fields.number<std::uint32_t>();
  return info;
}

bool is_ros_pose_type(std::string_view type) {
  const std::string name = short_type(type);
  return name == "geometry_msgs/PoseStamped" || name == "geometry_msgs/PoseWithCovarianceStamped" ||
         name == "geometry_msgs/TransformStamped" || name == "nav_msgs/Odometry";
}

RosPose read_pose_message(const BagTopic& topic, std::string_view bytes) {
  MessageFields fields(topic, bytes);
  const Timestamp stamp = take_header(fields);
  const std::string type = short_type(topic.type);
  if (type == "geometry_msgs/TransformStamped" || type == "nav_msgs/Odometry")
    fields.text();  // child_frame_id
  return take_pose(fields, stamp);
}

bool is_ros_path_type(std::string_view type) {
  return short_type(type) == "nav_msgs/Path";
}

bool is_tf_type(std::string_view type) {
  const std::string name = short_type(type);
  return name == "tf2_msgs/TFMessage" || name == "tf/tfMessage";
}

std::vector<RosPose> read_path_message(const BagTopic& topic, std::string_view bytes) {
  MessageFields fields(topic, bytes);
  take_header(fields);
  std::vector<RosPose> poses;
  for (auto left = fields.number<std::uint32_t>(); left > 0; --left) {
    const Timestamp stamp = take_header(fields);
    poses.push_back(take_pose(fields, stamp));
  }
  return poses;
}

std::vector<RosTransform> read_tf_message(const BagTopic& topic, std::string_view bytes) {
  MessageFields fields(topic, bytes);
  std::vector<RosTransform> transforms;
  for (auto left = fields.number<std::uint32_t>(); left > 0; --left) {
    const RosHeader header = take_whole_header(fields);
    const std::string_view child = fields.text();
    transforms.push_back(
        {take_pose(fields, header.stamp), without_slash(header.frame_id), without_slash(child)});
  }
  return transforms;
}

}  // namespace apriltrack
