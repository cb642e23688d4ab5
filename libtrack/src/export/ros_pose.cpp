#include "apriltrack/export/ros_pose.h"

#include <bit>
#include <cstdint>
#include <limits>

#include "apriltrack/base/error.h"
#include "apriltrack/io/byte_order.h"

namespace apriltrack {
namespace {

/// Plain CDR, little-endian: numbers stand at multiples of their size, counted behind the four bytes that say
/// so.
class CdrWriter {
 public:
  void u32(std::uint32_t value) { number(value, sizeof value); }
  void real(double value) { number(std::bit_cast<std::uint64_t>(value), sizeof value); }
  /// With a zero at its end, which counts.
  void text(std::string_view value) {
    u32(static_cast<std::uint32_t>(value.size() + 1));
    bytes_.append(value).push_back('\0');
  }
  std::string message() const { return std::string("\x00\x01\x00\x00", 4) + bytes_; }

 private:
  void number(std::uint64_t value, std::size_t size) {
    while (bytes_.size() % size != 0) bytes_.push_back('\0');
    append_little_endian(bytes_, value, size);
  }

  std::string bytes_;
};

}  // namespace

Matrix6d ros_covariance(const Pose& T_frame_pose, const Matrix6d& covariance) {
  // To first order T * exp([rho; phi]) moves the origin by R * rho and turns by R * phi on the left.
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = T_frame_pose.rotation_matrix();
  return turn * covariance * turn.transpose();
}

std::string_view ros_pose_type() {
  return "geometry_msgs/msg/PoseWithCovarianceStamped";
}

std::string_view ros_pose_definition() {
  return "std_msgs/Header header\n"
         "PoseWithCovariance pose\n"
         "================================================================================\n"
         "MSG: std_msgs/Header\n"
         "builtin_interfaces/Time stamp\n"
         "string frame_id\n"
         "================================================================================\n"
         "MSG: builtin_interfaces/Time\n"
         "int32 sec\n"
         "uint32 nanosec\n"
         "================================================================================\n"
         "MSG: geometry_msgs/PoseWithCovariance\n"
         "Pose pose\n"
         "float64[36] covariance\n"
         "================================================================================\n"
         "MSG: geometry_msgs/Pose\n"
         "Point position\n"
         "Quaternion orientation\n"
         "================================================================================\n"
         "MSG: geometry_msgs/Point\n"
         "float64 x\n"
         "float64 y\n"
         "float64 z\n"
         "================================================================================\n"
         "MSG: geometry_msgs/Quaternion\n"
         "float64 x\n"
         "float64 y\n"
         "float64 z\n"
         "float64 w\n";
}

std::string ros_pose_cdr(Timestamp time, std::string_view frame, const Pose& T_frame_pose,
                         const Matrix6d& covariance) {
  if (time.ns < 0 || time.ns / kNsPerSecond > std::numeric_limits<std::int32_t>::max())
    throw invalid_input(format_seconds(time) + " s",
                        "is no time that ROS has: these are from 1970 to January 2038");
  CdrWriter cdr;
  cdr.u32(static_cast<std::uint32_t>(time.ns / kNsPerSecond));
  cdr.u32(static_cast<std::uint32_t>(time.ns % kNsPerSecond));
  cdr.text(frame);
  const Eigen::Vector3d& t = T_frame_pose.translation();
  const Eigen::Quaterniond& q = T_frame_pose.rotation();
  for (const double value : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}) cdr.real(value);
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column < 6; ++column) cdr.real(covariance(row, column));
  return cdr.message();
}

}  // namespace apriltrack
