#include <gmock/gmock.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>

#include "apriltrack/geometry/rotation.h"
#include "apriltrack/geometry/tag_corners.h"
#include "measured_walls.h"

// Where the map's frame lies by what was measured.

namespace apriltrack {
namespace {

using test::calibrate;
using test::error_of;
using test::gravity;
using test::noisy_frames;
using test::position;
using test::SyntheticWorld;
using test::tag36h11;
using test::true_tag;
using test::walls;
using ::testing::AnyOf;
using ::testing::HasSubstr;

TEST(Constraints, FloorAndUprightTagsLevelTheMap) {
  SyntheticWorld world;
  world.rig.cameras.push_back(test::perspective_camera());
  test::add_tag(world, 0.2, test::looking_along({0.0, 0.0, 0.0}, {0.0, 0.0, -1.0}, 0.4));
  test::add_tag(world, 0.2, test::looking_along({0.6, 0.1, 0.0}, {0.0, 0.0, -1.0}, 1.4));
  test::add_tag(world, 0.2, test::looking_along({0.2, 0.8, 0.4}, {0.1, 1.0, 0.0}));
  test::add_tag(world, 0.2, test::looking_along({0.7, 0.8, 0.5}, {0.0, 1.0, 0.0}));
  for (int k = 0; k < 16; ++k)
    world.T_world_rig.push_back(
        test::looking_along({0.3 + 0.7 * std::cos(0.8 * k), -0.9 + 0.2 * std::sin(k), 1.0},
                            {-0.4 * std::cos(0.8 * k), 1.0, -0.75}));
  const CalibrationOptions options{
      .constraints = {{.what = FloorConstraint{tag36h11(0), 0.001, 0.01}},
                      {.what = FloorConstraint{tag36h11(1), 0.001, std::nullopt}},
                      {.what = UprightConstraint{tag36h11(2), 0.005}},
                      {.what = UprightConstraint{tag36h11(3), 0.005}}}};
  const CalibrationResult result = calibrate(world, test::exact_detections(world), options);
  ASSERT_EQ(result.map.tags.size(), 4u);
  for (int id = 0; id < 4; ++id) {
    const Pose& T_map_tag = result.map.find(tag36h11(id))->T_map_tag;
    const Pose& truth = world.map.find(tag36h11(id))->T_map_tag;
    EXPECT_NEAR(T_map_tag.translation().z(), truth.translation().z(), 1e-6);
    EXPECT_NEAR((T_map_tag.rotation() * Eigen::Vector3d::UnitZ()).z(),
                (truth.rotation() * Eigen::Vector3d::UnitZ()).z(), 1e-6);
  }
  EXPECT_THAT(result.gauge, HasSubstr("kept as with tag36h11/0 held at the origin: heading, x, y"));
}

TEST(Constraints, GravityInTheFrameOfACameraLevelsTheMap) {
  SyntheticWorld world = walls();
  Camera second = test::perspective_camera("cam1");
  second.T_this_previous = Pose(rotation_exp({0.3, -0.4, 0.1}), Eigen::Vector3d(0.2, 0.1, -0.3));
  world.rig.cameras.push_back(second);
  const Pose T_camera_world = world.rig.T_camera_rig(1) * world.T_world_rig[4].inverse();
  CalibrationOptions options{
      .constraints = {
          {.what = CameraGravityConstraint{
               "cam1", {200'000'000}, T_camera_world.rotation() * -Eigen::Vector3d::UnitZ(), 0.002}}}};
  const auto frames = test::exact_detections(world);
  const CalibrationResult result = calibrate(world, frames, options);
  for (const MapTag& tag : result.map.tags) {
    const Eigen::Vector3d up(0.0, 0.0, 1.0);
    const Pose& truth = world.map.find(tag.key)->T_map_tag;
    EXPECT_LT((tag.T_map_tag.rotation().conjugate() * up - truth.rotation().conjugate() * up).norm(), 1e-6);
  }
  EXPECT_THAT(result.gauge, HasSubstr("measured: gravity cam1 at 200000000; kept"));
  ASSERT_EQ(result.constraints.size(), 1u);
  EXPECT_GT(std::get<GravityConstraint>(result.constraints[0].what).sigma_rad, 0.002);
  EXPECT_LT(std::get<GravityConstraint>(result.constraints[0].what).sigma_rad, 0.01);

  std::get<CameraGravityConstraint>(options.constraints[0].what).camera = "cam2";
  EXPECT_THAT(error_of(ErrorKind::kInvalidInput, [&] { calibrate(world, frames, options); }),
              HasSubstr("camera 'cam2' is not in the camera file; it has cam0, cam1"));
  options.constraints[0].what = CameraGravityConstraint{"cam1", {200'000'001}, {0.0, 1.0, 0.0}, 0.002};
  EXPECT_THAT(error_of(ErrorKind::kInvalidInput, [&] { calibrate(world, frames, options); }),
              HasSubstr("timestamp_ns: cam1 shows no tag at that time; frames with tags run from 0 to "));
}

TEST(Constraints, GravityOfAnyTagIsNeverAmbiguous) {
  for (const MapTag& held : walls().map.tags) {
    for (const int id : {3, 9, 17}) {
      CalibrationOptions options{.held_tag = held.key, .constraints = {gravity(id, 0.01)}};
      const CalibrationResult result = calibrate(walls(), noisy_frames(9), options);
      EXPECT_THAT(result.gauge, HasSubstr("measured: gravity")) << to_string(held.key) << ' ' << id;
    }
  }
}

/// Of gravity, whatever its unit: 1e200 overflows when it is squared, 1e-300 vanishes.
TEST(Constraints, GravityOfAnyLengthIsOneDirection) {
  const CalibrationResult expected = calibrate(walls(), noisy_frames(9), {.constraints = {gravity(9, 0.01)}});
  for (const double length : {1e-300, 1e-12, 9.81, 1e200}) {
    CalibrationOptions options{.constraints = {gravity(9, 0.01)}};
    std::get<GravityConstraint>(options.constraints[0].what).direction_tag *= length;
    const CalibrationResult result = calibrate(walls(), noisy_frames(9), options);
    for (std::size_t i = 0; i < result.map.tags.size(); ++i)
      EXPECT_THAT(result.map.tags[i].T_map_tag, test::PoseNear(expected.map.tags[i].T_map_tag, 1e-9, 1e-9))
          << length;
  }
  CalibrationOptions none{.constraints = {gravity(9, 0.01)}};
  std::get<GravityConstraint>(none.constraints[0].what).direction_tag.setZero();
  EXPECT_THAT(error_of(ErrorKind::kInvalidInput, [&] { calibrate(walls(), noisy_frames(9), none); }),
              HasSubstr("direction: must be finite, and not zero"));
}

/// Eastings and northings as a surveyor gives them: millions of metres.
TEST(Constraints, CoordinatesOfUtmPutTheMapThere) {
  const Eigen::Vector3d origin_m(454321.0, 5412345.0, 312.0);
  CalibrationOptions options;
  for (const int id : {5, 9, 15, 19}) options.constraints.push_back(position(id, origin_m, 0.002));
  const CalibrationResult result = calibrate(walls(), test::exact_detections(walls()), options);
  const Pose T_utm_world(Eigen::Quaterniond::Identity(), origin_m);
  for (const MapTag& tag : result.map.tags)
    EXPECT_THAT(tag.T_map_tag,
                test::PoseNear(T_utm_world * walls().map.find(tag.key)->T_map_tag, 1e-6, 1e-6));
  EXPECT_EQ(result.gauge, "measured: position 5, position 9, position 15, position 19");
  const CalibrationResult near =
      calibrate(walls(), test::exact_detections(walls()),
                {.constraints = {position(5, test::kNoError, 0.002), position(9, test::kNoError, 0.002),
                                 position(15, test::kNoError, 0.002), position(19, test::kNoError, 0.002)}});
  for (std::size_t i = 0; i < near.map.tags.size(); ++i)
    EXPECT_LT((*result.map.tags[i].covariance - *near.map.tags[i].covariance).norm(),
              1e-6 * near.map.tags[i].covariance->norm());
}

/// Heights tell the tilt of an upright wall to second order only, whichever tag is held.
TEST(Constraints, HeightsOnOneUprightWallNeverTellAFrame) {
  for (const MapTag& held : walls().map.tags) {
    for (const std::uint64_t trial : {1, 2, 3}) {
      CalibrationOptions options{.held_tag = held.key};
      for (const int id : {3, 5, 7}) {
        const double height_m = true_tag(id).T_map_tag.translation().z();
        options.constraints.push_back(
            {.what = PositionConstraint{{"", id}, {std::nullopt, std::nullopt, height_m}, 0.002}});
      }
      EXPECT_THAT(error_of(ErrorKind::kNoResult, [&] { calibrate(walls(), noisy_frames(trial), options); }),
                  AnyOf(HasSubstr("two map frames"), HasSubstr("does not settle")))
          << to_string(held.key) << ' ' << trial;
    }
  }
}

/// Corners seen less corners of `T_camera_world`, as errors of each edge's two ends along its normal (the
/// ones that correlate), in sigmas.
Eigen::VectorXd edge_residuals(const FrameDetections& frame, const Pose& T_camera_world, double sigma_px,
                               double end_correlation) {
  Eigen::VectorXd residuals(8 * static_cast<Eigen::Index>(frame.detections.size()));
  const double of_sum = sigma_px * std::sqrt(2.0 * (1.0 + end_correlation));
  const double of_difference = sigma_px * std::sqrt(2.0 * (1.0 - end_correlation));
  Eigen::Index row = 0;
  for (const Detection& detection : frame.detections) {
    const MapTag& tag = true_tag(detection.tag.id);
    std::array<Eigen::Vector2d, 4> expected;
    for (std::size_t c = 0; c < 4; ++c)
      expected[c] = *walls().rig.cameras[0].model.project(T_camera_world *
                                                          (tag.T_map_tag * tag_corners(tag.size_m)[c]));
    for (std::size_t c = 0; c < 4; ++c) {
      const std::size_t next = (c + 1) % 4;
      const Eigen::Vector2d along = (expected[next] - expected[c]).normalized();
      const Eigen::Vector2d normal(-along.y(), along.x());
      const double a = normal.dot(detection.corners_px[c] - expected[c]);
      const double b = normal.dot(detection.corners_px[next] - expected[next]);
      residuals[row++] = (a + b) / of_sum;
      residuals[row++] = (a - b) / of_difference;
    }
  }
  return residuals;
}

/// Least squares by Gauss and Newton with numeric derivatives, from the truth.
Pose fit_frame(const FrameDetections& frame, const Pose& T_camera_world_start) {
  constexpr double kStep = 1e-6;
  Pose T_camera_world = T_camera_world_start;
  for (int iteration = 0; iteration < 4; ++iteration) {
    const Eigen::VectorXd residuals = edge_residuals(frame, T_camera_world, 0.15, -0.45);
    Eigen::Matrix<double, Eigen::Dynamic, 6> jacobian(residuals.size(), 6);
    for (int i = 0; i < 6; ++i) {
      const Vector6d step = kStep * Vector6d::Unit(i);
      jacobian.col(i) = (edge_residuals(frame, Pose::exp(step) * T_camera_world, 0.15, -0.45) -
                         edge_residuals(frame, Pose::exp(-step) * T_camera_world, 0.15, -0.45)) /
                        (2.0 * kStep);
    }
    const Vector6d step = -(jacobian.transpose() * jacobian).ldlt().solve(jacobian.transpose() * residuals);
    T_camera_world = Pose::exp(step) * T_camera_world;
  }
  return T_camera_world;
}

/// By how much the frame's orientation scatters about its worst axis, the tags where they are.
double scatter_rad(std::size_t index, double bias_px) {
  constexpr int kDraws = 200;
  const Pose T_camera_world = walls().T_world_rig[index].inverse();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (int draw = 0; draw < kDraws; ++draw) {
    RandomStream random(907, static_cast<std::uint64_t>(draw));
    std::vector<FrameDetections> frame = {test::exact_detections(walls()).at(index)};
    test::add_edge_noise(frame, 0.15, -0.45, random);
    if (bias_px > 0.0) test::add_edge_biases(frame, bias_px, -0.45, random);
    const Pose error = fit_frame(frame[0], T_camera_world) * T_camera_world.inverse();
    const Eigen::Vector3d turn = error.log().tail<3>();
    covariance += turn * turn.transpose() / kDraws;
  }
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvalues().maxCoeff());
}

/// The sigma of a camera's gravity in a tag's frame, by brute force: the frame's pose fitted to its views
/// with errors of both kinds drawn anew, the tags where they are.
TEST(Constraints, ACameraErrsByItsOwnFrameAndByWhatTagsKeep) {
  constexpr std::size_t kFrame = 4;
  const auto frames = noisy_frames(9);
  ASSERT_EQ(frames[kFrame].timestamp.ns, 200'000'000);
  for (const double bias_px : {0.0, 0.15}) {
    const CalibrationOptions options{
        .constraints = {{.what = CameraGravityConstraint{"cam0", {200'000'000}, {0.0, 1.0, 0.0}, 1e-6}}},
        .corner_bias_px = bias_px};
    const CalibrationResult result = calibrate(walls(), frames, options);
    const double claimed_rad = std::get<GravityConstraint>(result.constraints.at(0).what).sigma_rad;
    // 200 draws tell a sigma to 5 %, the noise that the fit measured is true to as much.
    EXPECT_NEAR(claimed_rad / scatter_rad(kFrame, bias_px), 1.0, 0.15) << bias_px;
  }
}

}  // namespace
}  // namespace apriltrack
