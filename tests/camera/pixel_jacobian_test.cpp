#include "apriltrack/camera/pixel_jacobian.h"

#include <gtest/gtest.h>

#include "apriltrack/geometry/pose.h"
#include "lens_models.h"
#include "support/numeric_jacobian.h"

namespace apriltrack {
namespace {

TEST(PixelJacobian, IsTheNumericOneOnEitherSideOfTheView) {
  const Pose T_camera_map(rotation_exp({0.4, -0.3, 0.9}), {0.1, -0.05, 1.3});
  const Eigen::Vector3d point_map(0.2, 0.15, -0.1);
  const Eigen::Vector3d point_camera = T_camera_map * point_map;
  for (const test::Lens& lens : test::all_lenses()) {
    Eigen::Matrix<double, 2, 3> by_point;
    ASSERT_TRUE(lens.model.project(point_camera, &by_point)) << lens.name;
    const Eigen::MatrixXd right = test::numeric_jacobian(
        [&](const Eigen::VectorXd& xi) -> Eigen::VectorXd {
          return lens.model.project(T_camera_map * Pose::exp(xi) * point_map).value();
        },
        6);
    const Eigen::MatrixXd left = test::numeric_jacobian(
        [&](const Eigen::VectorXd& xi) -> Eigen::VectorXd {
          return lens.model.project(Pose::exp(xi) * T_camera_map * point_map).value();
        },
        6);
    EXPECT_GT((left - right).norm(), 0.1 * right.norm()) << lens.name;  // or sides could be mixed up
    EXPECT_TRUE(test::jacobians_agree(pixel_jacobian(by_point * T_camera_map.rotation_matrix(), point_map),
                                      right, 1e-6))
        << lens.name;
    EXPECT_TRUE(test::jacobians_agree(pixel_jacobian(by_point, point_camera), left, 1e-6)) << lens.name;
  }
}

}  // namespace
}  // namespace apriltrack
