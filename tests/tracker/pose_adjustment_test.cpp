#include "pose_adjustment.h"

#include <gmock/gmock.h>

#include <numbers>

#include "corner_noise.h"
#include "pose_memory.h"
#include "support/numeric_jacobian.h"
#include "support/pose_matchers.h"
#include "synthetic_world.h"

namespace apriltrack {
namespace {

using test::PoseNear;

/// Of corners, so that whitened errors are in pixels.
constexpr double kPixel = 1.0;

std::vector<const TagObservation*> pointers(const std::vector<TagObservation>& observations) {
  std::vector<const TagObservation*> result;
  for (const TagObservation& observation : observations) result.push_back(&observation);
  return result;
}

TEST(PoseAdjustment, InformationIsThatOfTheNumericJacobian) {
  const Camera camera = test::camera_with(EquidistantDistortion({0.02, -0.01, 0.003, -0.001}));
  const TagMap map = test::room();
  RandomStream random(311);
  for (int i = 0; i < 10; ++i) {
    const Pose T_camera_map = test::random_T_map_camera(random).inverse();
    const auto observations = observe_mapped_tags(map, TagIndex(map), camera.model,
                                                  test::seen(camera, map, T_camera_map).detections, kPixel);
    ASSERT_EQ(observations.size(), 7U);
    const Eigen::MatrixXd jacobian = test::numeric_jacobian(
        [&](const Eigen::VectorXd& xi) {
          Eigen::VectorXd pixels(56);
          Eigen::Index row = 0;
          for (const Detection& d : test::seen(camera, map, T_camera_map * Pose::exp(xi)).detections) {
            for (const Eigen::Vector2d& corner : d.corners_px) pixels.segment<2>(row++ * 2) = corner;
          }
          return pixels;
        },
        6);
    EXPECT_TRUE(test::jacobians_agree(corner_information(camera.model, pointers(observations), T_camera_map),
                                      jacobian.transpose() * jacobian, 1e-6));
  }
}

TEST(PoseAdjustment, ConvergesFromFarOff) {
  const Camera camera = test::camera_with(RadtanDistortion({-0.28, 0.09, 5e-4, -3e-4}));
  const TagMap map = test::room();
  const auto observations = observe_mapped_tags(map, TagIndex(map), camera.model,
                                                test::seen(camera, map, Pose()).detections, kPixel);
  const Pose start = Pose::exp((Vector6d() << 0.1, -0.1, 0.2, 0.05, 0.1, -0.1).finished());
  const Pose found =
      adjust_pose(camera.model, pointers(observations), {RobustKernel::Shape::kHuber, 1.0}, start);
  EXPECT_THAT(found, PoseNear(Pose(), 1e-8, 1e-8));
}

TEST(PoseAdjustment, KernelsWeighAsTheirCostSlopes) {
  for (const auto shape : {RobustKernel::Shape::kCauchy, RobustKernel::Shape::kHuber}) {
    const RobustKernel kernel{shape, 1.5};
    for (const double squared : {0.01, 1.0, 2.0, 5.0, 100.0}) {
      const double slope = (kernel.cost(squared + 1e-6) - kernel.cost(squared - 1e-6)) / 2e-6;
      EXPECT_NEAR(kernel.weight(squared), slope, 1e-6);
    }
  }
}

TEST(PoseAdjustment, ATagSeenFromBehindFitsNoPose) {
  const Camera camera = test::camera_with(NoDistortion{});
  const TagMap map = test::only(test::room(), {0});
  const auto observations = observe_mapped_tags(map, TagIndex(map), camera.model,
                                                test::seen(camera, map, Pose()).detections, kPixel);
  ASSERT_EQ(observations.size(), 1U);
  const Pose T_front_back(rotation_exp({0.0, std::numbers::pi, 0.0}),
                          {0.0, 0.0, 4.4});  // half a turn about the tag
  EXPECT_TRUE(std::isinf(squared_error(camera.model, observations[0], T_front_back)));
  EXPECT_NEAR(squared_error(camera.model, observations[0], Pose()), 0.0, 1e-12);
}

TEST(CornerNoise, BlurIsThePathDuringTheExposure) {
  // A frontal camera that slides sideways: every corner moves by f * shift / depth.
  const Camera camera = test::camera_with(NoDistortion{});
  const TagMap map = test::only(test::room(), {0});
  const auto observations = observe_mapped_tags(map, TagIndex(map), camera.model,
                                                test::seen(camera, map, Pose()).detections, kPixel);
  PoseCandidate candidate;
  candidate.inliers = pointers(observations);
  const Pose before(Eigen::Quaterniond::Identity(), {0.1, 0.0, 0.0});
  const auto blur_px = corner_blur_px(camera.model, candidate, before, 0.04, 0.01);
  ASSERT_TRUE(blur_px);
  EXPECT_NEAR(*blur_px, 520.6 * 0.1 / 2.2 * (0.01 / 0.04), 1e-9);
}

TEST(CornerNoise, GrowsWithBlurAndIsNeverBelowThatOfSharpCorners) {
  const Camera camera = test::camera_with(NoDistortion{});
  const TagMap map = test::only(test::room(), {0});
  const auto observations =
      observe_mapped_tags(map, TagIndex(map), camera.model, test::seen(camera, map, Pose()).detections, 0.1);
  PoseCandidate candidate;
  candidate.inliers = pointers(observations);
  EXPECT_DOUBLE_EQ(expected_noise_scale(0.1, 0.0, candidate), 1.0);
  EXPECT_NEAR(0.1 * expected_noise_scale(0.1, 20.0, candidate), std::hypot(0.1, 0.025 * 20.0), 1e-9);
  EXPECT_GT(expected_noise_scale(0.1, std::nullopt, candidate), 1.0);
  EXPECT_DOUBLE_EQ(fitted_noise_scale(0.1, 1.0, candidate), 1.0) << "a perfect fit is luck";
  candidate.squared_error = 40.0 / (0.1 * 0.1);
  EXPECT_GT(0.1 * fitted_noise_scale(0.1, 1.0, candidate), 2.0);
}

/// The mean of a path with acceleration a over the exposure E is a E^2 / 24 beside its middle.
TEST(CornerNoise, OfAccelerationIsWhereTheMeanOfTheExposureLies) {
  const Vector6d acceleration = (Vector6d() << 5.0, 2.0, -1.0, 40.0, 80.0, -30.0).finished();
  constexpr double kStep_s = 0.04, kExposure_s = 0.016;
  const Pose start = Pose::exp((Vector6d() << 0.1, -0.2, 2.0, 0.3, 0.2, 0.1).finished());
  Vector6d mean = Vector6d::Zero();
  constexpr int kInstants = 1000;
  for (int i = 0; i < kInstants; ++i) {
    const double t = kExposure_s * ((i + 0.5) / kInstants - 0.5);
    mean += 0.5 * t * t * acceleration / kInstants;
  }
  // At rest before: the next step shows all of the acceleration.
  const Pose now = start * Pose::exp(kStep_s * kStep_s * acceleration);
  EXPECT_TRUE(uneven_motion_covariance(now, now, start, kStep_s, kExposure_s)
                  .isApprox(mean * mean.transpose(), 1e-4));
  EXPECT_TRUE(uneven_motion_covariance(now, start, start, kStep_s, 0.0).isZero());
}

/// Of a sine of angular frequency w, a E^2 / 24 is w E / 24 of the path v E.
TEST(CornerNoise, OfShakeGoesByTheSquareOfTheExposure) {
  const Vector6d velocity = (Vector6d() << 0.5, 0.2, -0.1, 0.4, 0.8, -0.3).finished();
  const Pose before = Pose::exp((Vector6d() << 0.1, -0.2, 2.0, 0.3, 0.2, 0.1).finished());
  const Pose now = before * Pose::exp(0.04 * velocity);
  for (const double exposure_s : {0.002, 0.016, 0.033}) {
    const Vector6d off = 2.0 * std::numbers::pi * 2.5 * exposure_s * exposure_s / 24.0 * velocity;
    EXPECT_TRUE(
        uneven_motion_covariance(now, before, now, 0.04, exposure_s).isApprox(off * off.transpose(), 1e-9));
  }
}

TEST(CornerNoise, OfCorrectedBitsIsFourTimesThatOfSharpCornersAndMayFitAsWell) {
  const Camera camera = test::camera_with(NoDistortion{});
  const TagMap map = test::only(test::room(), {0});
  FrameDetections frame = test::seen(camera, map, Pose());
  frame.detections.at(0).hamming = 1;
  const auto observations = observe_mapped_tags(map, TagIndex(map), camera.model, frame.detections, 0.1);
  EXPECT_TRUE(observations[0].covariance_px2.isApprox(0.4 * 0.4 * CornerCovariance::Identity()));
  EXPECT_TRUE(observations[0].whitening_per_px.isApprox(CornerCovariance::Identity() / 0.4));
  PoseCandidate candidate;
  candidate.inliers = pointers(observations);
  EXPECT_NEAR(0.4 * fitted_noise_scale(0.1, 0.0, candidate), 0.1, 1e-9);
}

TEST(PoseMemory, PredictsWithConstantVelocityWhileFresh) {
  const Vector6d velocity = (Vector6d() << 0.5, 0.2, -0.1, 0.4, 0.8, -0.3).finished();
  const auto pose_at = [&](double seconds) { return Pose::exp(seconds * velocity); };
  PoseMemory memory;
  EXPECT_TRUE(memory.predict({0}).empty());
  EXPECT_EQ(memory.log_prior({0}, Pose()), 0.0);
  memory.remember({0}, pose_at(0.0), std::nullopt);
  memory.remember({30'000'000}, pose_at(0.03), std::nullopt);
  const auto modes = memory.predict({90'000'000});
  ASSERT_EQ(modes.size(), 1U);
  EXPECT_THAT(modes[0].pose, PoseNear(pose_at(0.09), 1e-9, 1e-9));
  EXPECT_NEAR(memory.log_prior({90'000'000}, pose_at(0.09)), 0.0, 1e-9);
  const Pose flipped = pose_at(0.09) * Pose::exp((Vector6d() << 0, 0, 0, 1.2, 0, 0).finished());
  EXPECT_LT(memory.log_prior({90'000'000}, flipped), -6.0);
  EXPECT_GT(memory.log_prior({90'000'000}, flipped), -8.0) << "clear corners must be able to overrule";
  EXPECT_TRUE(memory.predict({400'000'000}).empty()) << "0.37 s old";
  EXPECT_TRUE(memory.predict({20'000'000}).empty()) << "time ran backwards";
}

TEST(PoseMemory, KeepsTheSecondModeWithItsWeight) {
  const Pose flipped = Pose::exp((Vector6d() << 0, 0, 0, 1.2, 0, 0).finished());
  PoseMemory memory;
  memory.remember({0}, Pose(), PoseMemory::Mode{flipped, 0.5});
  EXPECT_EQ(memory.predict({30'000'000}).size(), 2U);
  EXPECT_NEAR(memory.log_prior({30'000'000}, flipped), std::log(0.5), 0.01);
}

}  // namespace
}  // namespace apriltrack
