#include "apriltrack/geometry/planar_pnp.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "apriltrack/base/check.h"
#include "apriltrack/base/random.h"
#include "apriltrack/geometry/rotation.h"
#include "support/pose_matchers.h"

namespace apriltrack {
namespace {

using test::PoseNear;
using Rays = std::array<Eigen::Vector3d, 4>;

constexpr double kDegree = std::numbers::pi / 180.0;

Rays corners_tag(double size_m) {
  const double h = 0.5 * size_m;
  return {Eigen::Vector3d(-h, h, 0), Eigen::Vector3d(h, h, 0), Eigen::Vector3d(h, -h, 0),
          Eigen::Vector3d(-h, -h, 0)};
}

Rays rays_of(const Pose& T_camera_tag, double size_m) {
  Rays rays = corners_tag(size_m);
  for (Eigen::Vector3d& ray : rays) ray = (T_camera_tag * ray).normalized();
  return rays;
}

/// A tag in direction `ray`, turned by `tilt_rad` away from facing the camera.
Pose random_view(RandomStream& random, const Eigen::Vector3d& ray, double distance_m, double tilt_rad) {
  const Eigen::Quaterniond face_camera = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), ray);
  const double azimuth = random.uniform(0.0, 2.0 * std::numbers::pi);
  const Eigen::Vector3d tilt = tilt_rad * Eigen::Vector3d(std::cos(azimuth), std::sin(azimuth), 0.0);
  const Eigen::Vector3d roll(0.0, 0.0, random.uniform(-std::numbers::pi, std::numbers::pi));
  return {face_camera * rotation_exp(tilt) * rotation_exp(roll), distance_m * ray};
}

Eigen::Vector3d random_ray(RandomStream& random, double max_off_axis_rad) {
  const double off_axis = random.uniform(0.0, max_off_axis_rad);
  const double azimuth = random.uniform(0.0, 2.0 * std::numbers::pi);
  return {std::sin(off_axis) * std::cos(azimuth), std::sin(off_axis) * std::sin(azimuth), std::cos(off_axis)};
}

Rays with_noise(Rays rays, RandomStream& random, double sigma_rad) {
  for (Eigen::Vector3d& ray : rays) {
    ray = (ray + sigma_rad * Eigen::Vector3d{random.normal(), random.normal(), random.normal()}).normalized();
  }
  return rays;
}

/// Sum of squared sines of the angles between seen and predicted rays: written anew, not the library's.
double squared_error(const Rays& rays, const Pose& T_camera_tag, double size_m) {
  double sum = 0.0;
  const Rays predicted = rays_of(T_camera_tag, size_m);
  for (std::size_t i = 0; i < 4; ++i) sum += rays[i].cross(predicted[i]).squaredNorm();
  return sum;
}

bool is_in_front_and_facing(const Rays& rays, const Pose& T_camera_tag, double size_m) {
  const Rays corners = corners_tag(size_m);
  for (std::size_t i = 0; i < 4; ++i) {
    if ((T_camera_tag * corners[i]).dot(rays[i]) <= 0.0) return false;
  }
  return (T_camera_tag.rotation() * Eigen::Vector3d::UnitZ()).dot(T_camera_tag.translation()) > 0.0;
}

TEST(PlanarPnp, ExactCornersHaveTheTruePoseAmongTheSolutions) {
  RandomStream random(101);
  int num_checked = 0;
  int num_pairs = 0;
  for (int i = 0; i < 3000; ++i) {
    const double size_m = random.uniform(0.02, 0.5);
    const double distance_m = size_m * random.uniform(1.2, 40.0);
    // Rays up to 110 degrees off the axis: a fisheye sees behind itself.
    const Eigen::Vector3d ray = random_ray(random, 110.0 * kDegree);
    const double tilt_rad = random.uniform(0.0, 60.0) * kDegree;
    const Pose T_camera_tag = random_view(random, ray, distance_m, tilt_rad);
    const PlanarPoses poses = solve_planar_pnp(rays_of(T_camera_tag, size_m), size_m);
    ASSERT_FALSE(poses.empty()) << "view " << i;
    EXPECT_THAT(poses[0].T_camera_tag, PoseNear(T_camera_tag, 1e-6 * distance_m, 1e-5)) << "view " << i;
    EXPECT_LT(poses[0].rms_error_rad, 1e-9);
    if (poses.size() == 2) {
      EXPECT_LE(poses[0].rms_error_rad, poses[1].rms_error_rad);
    }
    num_pairs += poses.size() == 2;
    ++num_checked;
  }
  EXPECT_EQ(num_checked, 3000);
  EXPECT_GT(num_pairs, 2000);  // most tilted views from afar are ambiguous
}

TEST(PlanarPnp, EachSolutionIsAMinimumOfTheRayError) {
  RandomStream random(102);
  int num_solutions = 0;
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3d ray = random_ray(random, 0.5);
    const double distance_m = random.uniform(0.5, 3.0);
    const double tilt_rad = random.uniform(0.1, 1.0);
    const Pose truth = random_view(random, ray, distance_m, tilt_rad);
    const Rays rays = with_noise(rays_of(truth, 0.16), random, 1e-3);
    for (const PlanarPose& pose : solve_planar_pnp(rays, 0.16)) {
      const double error = squared_error(rays, pose.T_camera_tag, 0.16);
      EXPECT_NEAR(pose.rms_error_rad, std::sqrt(error / 8.0), 1e-9);
      for (int trial = 0; trial < 20; ++trial) {
        Vector6d xi;
        for (int k = 0; k < 6; ++k) xi(k) = 1e-3 * random.normal();
        EXPECT_GE(squared_error(rays, pose.T_camera_tag * Pose::exp(xi), 0.16), error * (1.0 - 1e-9));
      }
      ++num_solutions;
    }
  }
  EXPECT_GT(num_solutions, 400);
}

/// Slow and independent: compass search over the six perturbations, halving the step when nothing gets
/// better.
Pose minimise_by_compass_search(const Rays& rays, Pose pose, double size_m) {
  double error = squared_error(rays, pose, size_m);
  Eigen::Matrix<double, 6, 6> directions = Eigen::Matrix<double, 6, 6>::Identity();
  double step = 0.2;
  while (step > 1e-5) {
    bool improved = false;
    for (int k = 0; k < 12; ++k) {
      Vector6d xi = (k % 2 == 0 ? step : -step) * directions.col(k / 2);
      xi.head<3>() *= size_m;
      const Pose candidate = pose * Pose::exp(xi);
      const double candidate_error = squared_error(rays, candidate, size_m);
      if (candidate_error < error) {
        error = candidate_error;
        pose = candidate;
        improved = true;
      }
    }
    if (!improved) step *= 0.5;
  }
  return pose;
}

TEST(PlanarPnp, NoisyAmbiguousViewsLeaveNoMinimumUnfound) {
  RandomStream random(103);
  constexpr double kSize_m = 0.16;
  int num_views = 0;
  int num_starts = 0;
  int num_second_minima = 0;
  for (int i = 0; i < 40; ++i) {
    const double distance_m = random.uniform(1.0, 4.0);
    const Eigen::Vector3d ray = random_ray(random, 0.5);
    const double tilt_rad = random.uniform(0.0, 1.0);
    const Pose truth = random_view(random, ray, distance_m, tilt_rad);
    const Rays rays = with_noise(rays_of(truth, kSize_m), random, 5e-4);  // 0.3 px at f = 600
    const PlanarPoses poses = solve_planar_pnp(rays, kSize_m);
    if (poses.empty()) continue;
    ++num_views;
    const double lowest = squared_error(rays, poses[0].T_camera_tag, kSize_m);
    for (int start = 0; start < 8; ++start) {
      const double guessed_m = distance_m * random.uniform(0.8, 1.2);
      const double guessed_tilt_rad = random.uniform(0.0, 1.3);
      const Pose guess = random_view(random, ray, guessed_m, guessed_tilt_rad);
      const Pose found = minimise_by_compass_search(rays, guess, kSize_m);
      if (!is_in_front_and_facing(rays, found, kSize_m)) continue;
      EXPECT_GE(squared_error(rays, found, kSize_m), lowest * (1.0 - 1e-6))
          << "view " << i << " start " << start;
      const double apart_rad = rotation_angle_rad(found.rotation(), poses[0].T_camera_tag.rotation());
      if (apart_rad > 0.3) {
        ASSERT_EQ(poses.size(), 2U) << "view " << i << ": the search found a second minimum";
        const double second = squared_error(rays, poses[1].T_camera_tag, kSize_m);
        EXPECT_GE(squared_error(rays, found, kSize_m), second * (1.0 - 1e-6))
            << "view " << i << " start " << start;
        ++num_second_minima;
      }
      ++num_starts;
    }
  }
  EXPECT_EQ(num_views, 40);
  EXPECT_GT(num_starts, 250);
  EXPECT_GT(num_second_minima, 60);
}

TEST(PlanarPnp, TheMirroredViewIsTheSecondSolution) {
  // Far away and tilted, the second minimum lies near the mirror image about the line of sight, with the
  // first's place.
  RandomStream random(104);
  for (int i = 0; i < 200; ++i) {
    const double tilt_rad = random.uniform(0.5, 1.0);
    const Pose truth = random_view(random, Eigen::Vector3d::UnitZ(), 4.0, tilt_rad);
    const PlanarPoses poses = solve_planar_pnp(rays_of(truth, 0.16), 0.16);
    ASSERT_EQ(poses.size(), 2U);
    const Eigen::Vector3d normal = truth.rotation() * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d second_normal = poses[1].T_camera_tag.rotation() * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d mirrored_normal(-normal.x(), -normal.y(), normal.z());
    EXPECT_LT(std::acos(std::min(1.0, second_normal.dot(mirrored_normal))), 3.0 * kDegree);
    EXPECT_LT((poses[1].T_camera_tag.translation() - truth.translation()).norm(), 0.02);
  }
}

TEST(PlanarPnp, AFrontalViewHasOneSolution) {
  const Pose truth(Eigen::Quaterniond::Identity(), {0.0, 0.0, 1.0});
  const PlanarPoses poses = solve_planar_pnp(rays_of(truth, 0.16), 0.16);
  ASSERT_EQ(poses.size(), 1U);
  EXPECT_THAT(poses[0].T_camera_tag, PoseNear(truth, 1e-8, 1e-6));
}

TEST(PlanarPnp, DegenerateCornersHaveNoSolution) {
  const auto solve = [](const std::array<Eigen::Vector2d, 4>& points) {
    Rays rays;
    for (std::size_t i = 0; i < 4; ++i) rays[i] = points[i].homogeneous().normalized();
    return solve_planar_pnp(rays, 0.16);
  };
  using P = Eigen::Vector2d;
  EXPECT_EQ(solve({P(-.1, .1), P(.1, .1), P(.1, -.1), P(-.1, -.1)}).size(), 1U) << "the good one";
  EXPECT_TRUE(solve({P(-.1, .1), P(0, .1), P(.1, .1), P(.2, .1)}).empty()) << "collinear";
  EXPECT_TRUE(solve({P(-.1, .1), P(.1, .1), P(.1, .1), P(-.1, -.1)}).empty()) << "two coincide";
  EXPECT_TRUE(solve({P(0, 0), P(0, 0), P(0, 0), P(0, 0)}).empty()) << "all coincide";
  EXPECT_TRUE(solve({P(-.1, .1), P(.1, .1), P(0, 0), P(.1, -.1)}).empty()) << "three on a line or dented";
  EXPECT_TRUE(solve({P(-.1, .1), P(.1, -.1), P(.1, .1), P(-.1, -.1)}).empty()) << "crossed";
  EXPECT_TRUE(solve({P(-.1, -.1), P(.1, -.1), P(.1, .1), P(-.1, .1)}).empty())
      << "mirrored: seen from behind";
}

TEST(PlanarPnp, RaysThatAreNotFiniteOrOppositeHaveNoSolution) {
  Rays rays = rays_of(Pose(Eigen::Quaterniond::Identity(), {0.0, 0.0, 1.0}), 0.16);
  Rays opposite = rays;
  opposite[2] = -opposite[2];
  EXPECT_TRUE(solve_planar_pnp(opposite, 0.16).empty());
  rays[1].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(solve_planar_pnp(rays, 0.16).empty());
  rays[1].x() = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(solve_planar_pnp(rays, 0.16).empty());
}

TEST(PlanarPnp, RequiresAPositiveSize) {
  const Rays rays = rays_of(Pose(Eigen::Quaterniond::Identity(), {0.0, 0.0, 1.0}), 0.16);
  EXPECT_THROW(solve_planar_pnp(rays, 0.0), MisuseError);
  EXPECT_THROW(solve_planar_pnp(rays, std::numeric_limits<double>::quiet_NaN()), MisuseError);
}

TEST(PlanarPnp, RandomQuadsNeverGiveNaN) {
  RandomStream random(105);
  int num_solved = 0;
  for (int i = 0; i < 5000; ++i) {
    Rays rays;
    const double spread = std::pow(10.0, random.uniform(-9.0, 1.0));
    for (Eigen::Vector3d& ray : rays) {
      ray = Eigen::Vector3d{spread * random.normal(), spread * random.normal(), 1.0}.normalized();
    }
    for (const PlanarPose& pose : solve_planar_pnp(rays, 0.16)) {
      EXPECT_TRUE(pose.T_camera_tag.is_finite());
      EXPECT_TRUE(std::isfinite(pose.rms_error_rad));
      EXPECT_TRUE(is_in_front_and_facing(rays, pose.T_camera_tag, 0.16));
      ++num_solved;
    }
  }
  EXPECT_GT(num_solved, 500);
}

}  // namespace
}  // namespace apriltrack
