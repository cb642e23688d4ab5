// ROS' pose with covariance: against sampled poses, and byte by byte.
#include "apriltrack/export/ros_pose.h"

#include <gmock/gmock.h>

#include <Eigen/Cholesky>
#include <cstring>
#include <random>

#include "apriltrack/base/error.h"
#include "support/error_message.h"

namespace apriltrack::test {
namespace {

/// No two of its axes alike, translation and rotation tied together; 1 to 5 mm and mrad.
Matrix6d uneven_covariance() {
  Matrix6d root = Matrix6d::Zero();
  root.diagonal() << 1e-3, 3e-3, 5e-3, 2e-3, 1e-3, 4e-3;
  root(3, 0) = 1.5e-3;
  root(5, 1) = -2e-3;
  root(4, 2) = 0.7e-3;
  return root * root.transpose();
}

TEST(RosPose, CovarianceIsThatOfSampledPoses) {
  const Pose T_world_camera(Eigen::Quaterniond(0.4, -0.7, 0.5, 0.32), {4.0, -2.0, 7.0});
  const Matrix6d covariance = uneven_covariance();
  const Matrix6d root = covariance.llt().matrixL();
  std::mt19937_64 random(20261128);
  std::normal_distribution<double> normal;
  constexpr int kSamples = 200'000;
  Matrix6d sum = Matrix6d::Zero();
  for (int i = 0; i < kSamples; ++i) {
    const Vector6d xi = root * Vector6d::NullaryExpr([&] { return normal(random); });
    const Pose moved = T_world_camera * Pose::exp(xi);
    // As ROS says: positions along the fixed frame's axes, small turns about its fixed axes.
    const Eigen::AngleAxisd turn(moved.rotation() * T_world_camera.rotation().conjugate());
    Vector6d error;
    error << moved.translation() - T_world_camera.translation(), turn.angle() * turn.axis();
    sum += error * error.transpose();
  }
  const Matrix6d sampled = sum / kSamples;
  const Matrix6d told = ros_covariance(T_world_camera, covariance);
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      const double scale = std::sqrt(sampled(i, i) * sampled(j, j));
      EXPECT_NEAR(told(i, j) / scale, sampled(i, j) / scale, 0.015) << i << " " << j;  // 5 sigma of sampling
    }
  }
  EXPECT_GT((told - covariance).norm() / covariance.norm(), 0.3);  // the pose is turned far enough to tell
}

double real_at(const std::string& bytes, std::size_t at) {
  double value = 0.0;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

TEST(RosPose, IsPlainCdr) {
  Matrix6d covariance;
  for (int i = 0; i < 36; ++i) covariance(i / 6, i % 6) = i + 0.5;
  const std::string bytes =
      ros_pose_cdr({1'700'000'001'000'000'002}, "world",
                   {Eigen::Quaterniond(0.8, 0.0, 0.6, 0.0), {1.5, -2.25, 0.125}}, covariance);
  // Encapsulation, seconds 0x6553F101, nanoseconds, six bytes of "world" and its zero, padding to 24 behind
  // the encapsulation.
  const std::string start(
      "\x00\x01\x00\x00"
      "\x01\xF1\x53\x65"
      "\x02\x00\x00\x00"
      "\x06\x00\x00\x00"
      "world\0"
      "\0\0\0\0\0\0",
      28);
  EXPECT_EQ(bytes.substr(0, 28), start);
  ASSERT_EQ(bytes.size(), 28u + 43u * 8u);
  const std::vector<double> pose = {1.5, -2.25, 0.125, 0.0, 0.6, 0.0, 0.8};
  for (std::size_t i = 0; i < pose.size(); ++i) EXPECT_EQ(real_at(bytes, 28 + 8 * i), pose[i]);
  for (std::size_t i = 0; i < 36; ++i)
    EXPECT_EQ(real_at(bytes, 28 + 56 + 8 * i), static_cast<double>(i) + 0.5);
}

TEST(RosPose, TimesThatRosHasNotAreRefused) {
  const auto write = [](std::int64_t ns) { ros_pose_cdr({ns}, "world", {}, Matrix6d::Identity()); };
  EXPECT_THAT(message_of([&] { write(-1); }), testing::HasSubstr("from 1970"));
  EXPECT_THAT(message_of([&] { write(2'147'483'648'000'000'000); }), testing::HasSubstr("January 2038"));
  EXPECT_NO_THROW(write(2'147'483'647'999'999'999));
}

}  // namespace
}  // namespace apriltrack::test
