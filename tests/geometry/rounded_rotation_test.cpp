#include "apriltrack/geometry/rounded_rotation.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

namespace apriltrack {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// By the angle whose cosine is 0.6, about z.
Eigen::Matrix3d turned() {
  Eigen::Matrix3d R;
  R << 0.6, -0.8, 0, 0.8, 0.6, 0, 0, 0, 1;
  return R;
}

// (1 + e)^2 - 1 = 2 e + e^2 of a matrix that is e too large.
TEST(RoundedRotation, IsWithinTheTolerance) {
  const Eigen::Matrix3d larger = 1.01 * turned();
  EXPECT_NEAR(rotation_defect(larger), 0.0201, 1e-12);
  ASSERT_TRUE(rounded_rotation(larger, 0.0202));
  EXPECT_LT((*rounded_rotation(larger, 0.0202) - turned()).norm(), 1e-14);
  EXPECT_FALSE(rounded_rotation(larger, 0.0200));
  Eigen::Matrix3d skewed = turned();
  skewed(2, 0) = 0.01;  // its last row meets the first at 0.6 * 0.01, the second at 0.8 * 0.01
  EXPECT_NEAR(rotation_defect(skewed), 0.008, 1e-12);
}

TEST(RoundedRotation, IsNoMirrorImageAndNoNumberThatIsNone) {
  Eigen::Matrix3d mirrored = turned();
  mirrored(2, 2) = -1.0;
  EXPECT_LT(rotation_defect(mirrored), 1e-15);
  EXPECT_FALSE(rounded_rotation(mirrored, 0.01));
  for (int i = 0; i < 9; ++i) {
    for (const double wrong : {kNan, std::numeric_limits<double>::infinity(), 1e300}) {
      Eigen::Matrix3d matrix = turned();
      matrix(i / 3, i % 3) = wrong;
      EXPECT_FALSE(rounded_rotation(matrix, 0.01)) << i << " " << wrong;
    }
  }
}

TEST(RoundedRotation, OfAQuaternionHasLengthOne) {
  EXPECT_TRUE(is_rounded_rotation({0.6, 0, 0.8, 0}, 1e-15));
  EXPECT_TRUE(is_rounded_rotation({0.606, 0, 0.808, 0}, 0.0101));
  EXPECT_FALSE(is_rounded_rotation({0.606, 0, 0.808, 0}, 0.0099));
  EXPECT_FALSE(is_rounded_rotation({0.594, 0, 0.792, 0}, 0.0099));
  EXPECT_FALSE(is_rounded_rotation({0, 0, 0, 0}, 0.05));
  EXPECT_FALSE(is_rounded_rotation({kNan, 0, 0, 1}, 0.05));
  EXPECT_FALSE(is_rounded_rotation({1e200, 0, 1e200, 0}, 0.05));
}

}  // namespace
}  // namespace apriltrack
