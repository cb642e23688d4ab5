#include "view_cone.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "apriltrack/base/random.h"
#include "apriltrack/geometry/pose.h"
#include "apriltrack/geometry/rotation.h"
#include "apriltrack/tags/tag_corners.h"
#include "camera/lens_models.h"

namespace apriltrack {
namespace {

/// A tag at random around the camera, turned at random.
struct RandomTag {
  double size_m;
  Pose T_camera_tag;

  explicit RandomTag(RandomStream& random) : size_m(random.uniform(0.05, 0.6)) {
    Eigen::Vector3d direction, turn;
    for (int k = 0; k < 3; ++k) {
      direction[k] = random.normal();
      turn[k] = random.normal();
    }
    T_camera_tag = {rotation_exp(2.0 * turn), random.uniform(0.3, 4.0) * direction.normalized()};
  }

  Eigen::Vector3d centre() const { return T_camera_tag.translation(); }
  double radius_m() const { return std::numbers::sqrt2 * 0.5 * size_m; }
};

bool shows_a_corner(const CameraModel& model, int width, int height, const RandomTag& tag) {
  return std::ranges::any_of(tag_corners(tag.size_m), [&](const Eigen::Vector3d& corner) {
    const auto pixel = model.project(tag.T_camera_tag * corner);
    return pixel && pixel->x() >= 0.0 && pixel->y() >= 0.0 && pixel->x() <= width - 1 &&
           pixel->y() <= height - 1;
  });
}

/// Beside or behind the camera altogether: not one of the corners, nor the centre, within 80 degrees of the
/// axis, nor nearer to it than twice the image's farthest pixel.
bool is_far_off(const RandomTag& tag, double widest_rad) {
  const double least_rad = std::max(80.0 / 180.0 * std::numbers::pi, 1.2 * widest_rad);
  double nearest_rad = std::atan2(tag.centre().head<2>().norm(), tag.centre().z());
  for (const Eigen::Vector3d& corner : tag_corners(tag.size_m)) {
    const Eigen::Vector3d at = tag.T_camera_tag * corner;
    nearest_rad = std::min(nearest_rad, std::atan2(at.head<2>().norm(), at.z()));
  }
  return nearest_rad > least_rad;
}

/// The farthest off the axis of all pixels, one by one; pi where one has no ray.
double farthest_pixel_rad(const CameraModel& model, int width, int height) {
  double angle_rad = 0.0;
  for (int y = 0; y < height; y += 3) {
    for (int x = 0; x < width; x += 3) {
      const auto ray = model.unproject(Eigen::Vector2d(x, y));
      if (!ray) return std::numbers::pi;
      angle_rad = std::max(angle_rad, std::atan2(ray->head<2>().norm(), ray->z()));
    }
  }
  return angle_rad;
}

TEST(ViewCone, HoldsEveryTagThatShowsACornerAndRejectsMostOthers) {
  RandomStream random(1);
  int num_lenses_that_reject = 0;
  for (const test::Lens& lens : test::all_lenses()) {
    const Pinhole& pinhole = lens.model.pinhole();
    // About the principal point, and one that it is far off the middle of.
    for (const double stretch : {2.0, 1.4}) {
      const int width = static_cast<int>(stretch * pinhole.cx);
      const int height = static_cast<int>(stretch * pinhole.cy);
      const double cone_rad = max_view_angle_rad(lens.model, width, height);
      const double widest_rad = farthest_pixel_rad(lens.model, width, height);
      EXPECT_GE(cone_rad, widest_rad) << lens.name;
      int num_shown = 0, num_far = 0, num_far_rejected = 0;
      for (int i = 0; i < 20'000; ++i) {
        const RandomTag tag(random);
        const bool may_show = may_be_in_view(tag.centre(), tag.radius_m(), cone_rad);
        if (shows_a_corner(lens.model, width, height, tag)) {
          ++num_shown;
          EXPECT_TRUE(may_show) << lens.name << " " << tag.centre().transpose();
        }
        if (!is_far_off(tag, widest_rad)) continue;
        ++num_far;
        num_far_rejected += may_show ? 0 : 1;
      }
      EXPECT_GT(num_shown, 50) << lens.name;
      // Where the model ends within the image, or it shows nearly everything, nothing is far off.
      if (cone_rad >= std::numbers::pi || widest_rad > 2.2) continue;
      ++num_lenses_that_reject;
      EXPECT_GT(num_far, 1000) << lens.name;
      EXPECT_GT(num_far_rejected, 0.9 * num_far) << lens.name << " " << cone_rad << " " << widest_rad;
    }
  }
  EXPECT_GE(num_lenses_that_reject, 14);
}

TEST(ViewCone, HoldsATagRoundTheCamera) {
  for (const double z : {-0.05, 0.0, 0.05}) EXPECT_TRUE(may_be_in_view({0.0, 0.0, z}, 0.1, 0.5));
  EXPECT_FALSE(may_be_in_view({0.0, 0.0, -0.2}, 0.1, 0.5));
  // Its rim just in the cone of 0.5 rad, and just out of it, at one metre.
  const double sees_rad = 0.5 + std::asin(0.1);
  for (const double off_rad : {-1e-6, 1e-6}) {
    const double angle_rad = sees_rad + off_rad;
    EXPECT_EQ(may_be_in_view({0.0, std::sin(angle_rad), std::cos(angle_rad)}, 0.1, 0.5), off_rad < 0.0);
  }
}

}  // namespace
}  // namespace apriltrack
