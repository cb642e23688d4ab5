#include <gmock/gmock.h>

#include <Eigen/Cholesky>
#include <array>
#include <cmath>

#include "constraints/map_frame_start.h"
#include "measured_walls.h"

// Maps that keep to what was measured, from the corners of worlds that are known.

namespace apriltrack {
namespace {

using test::calibrate;
using test::distance;
using test::error_of;
using test::kNoError;
using test::noisy_frames;
using test::position;
using test::SyntheticWorld;
using test::tag36h11;
using test::true_tag;
using test::walls;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

TEST(Constraints, MeasuredCoordinatesPutTheMapWhereTheyWereMeasured) {
  const CalibrationOptions options{.constraints = {position(5, kNoError, 0.002), position(9, kNoError, 0.002),
                                                   position(15, kNoError, 0.002),
                                                   position(19, kNoError, 0.002)}};
  const CalibrationResult result = calibrate(walls(), test::exact_detections(walls()), options);
  ASSERT_EQ(result.map.tags.size(), 10u);
  EXPECT_THAT(result.warnings, IsEmpty());
  for (const MapTag& tag : result.map.tags)
    EXPECT_THAT(tag.T_map_tag, test::PoseNear(walls().map.find(tag.key)->T_map_tag, 1e-6, 1e-6));
  ASSERT_EQ(result.rig_poses.size(), walls().T_world_rig.size());
  for (std::size_t k = 0; k < result.rig_poses.size(); ++k)
    EXPECT_THAT(result.rig_poses[k].T_map_rig, test::PoseNear(walls().T_world_rig[k], 1e-5, 1e-5));
  EXPECT_EQ(result.gauge, "measured: position 5, position 9, position 15, position 19");
  ASSERT_EQ(result.constraint_audits.size(), 4u);
  for (const ConstraintAudit& audit : result.constraint_audits) EXPECT_LT(*audit.z, 1e-3) << audit.title;
}

TEST(Constraints, ErrorsAndAuditsAreAsLargeAsTheCovarianceSays) {
  // Means of xi' C^-1 xi / 6 over all tags, the held one too, and of z squared, over worlds.
  double sum = 0.0, squares = 0.0;
  int count = 0, num_z = 0;
  for (std::uint64_t trial = 0; trial < 20; ++trial) {
    RandomStream random(504, trial);
    CalibrationOptions options{.corner_bias_px = 0.0};
    for (const int id : {3, 7, 11, 17})
      options.constraints.push_back(
          position(id, 0.005 * Eigen::Vector3d{random.normal(), random.normal(), random.normal()}, 0.005));
    for (const auto& [a, b] : {std::pair(5, 13), {5, 15}, {9, 19}})
      options.constraints.push_back(distance(a, b, 0.001 * random.normal(), 0.001));
    const CalibrationResult result = calibrate(walls(), noisy_frames(trial), options);
    for (const MapTag& tag : result.map.tags) {
      const Vector6d xi = (tag.T_map_tag.inverse() * walls().map.find(tag.key)->T_map_tag).log();
      sum += xi.dot(tag.covariance->ldlt().solve(xi)) / 6.0;
      ++count;
    }
    for (const ConstraintAudit& audit : result.constraint_audits) {
      if (audit.type != "distance") continue;
      squares += *audit.z * *audit.z;
      ++num_z;
    }
  }
  ASSERT_EQ(count, 200);
  ASSERT_EQ(num_z, 60);
  // Errors of the frame are common to the tags of a world: 20 draws of six numbers and more.
  EXPECT_GT(sum / count, 0.75);
  EXPECT_LT(sum / count, 1.3);
  EXPECT_GT(squares / num_z, 0.5);  // 2.7 standard deviations of 60 squares
  EXPECT_LT(squares / num_z, 1.6);
}

TEST(Constraints, DistancesAndBoardsKeepTheHeldTagAtTheOrigin) {
  const Pose T_ab = true_tag(5).T_map_tag.inverse() * true_tag(7).T_map_tag;
  const CalibrationOptions options{
      .held_tag = tag36h11(7),
      .constraints = {distance(3, 11, 0.0, 0.0001),
                      {.what = RelativePoseConstraint{
                           {"", 5}, {"", 7}, T_ab.translation(), T_ab.rotation(), 1e-5, 1e-5}}}};
  const CalibrationResult with = calibrate(walls(), noisy_frames(1), options);
  EXPECT_EQ(with.gauge, "tag36h11/7 held at the origin");
  EXPECT_EQ(with.map.find(tag36h11(7))->T_map_tag.matrix(), Pose().matrix());
  EXPECT_TRUE(with.map.find(tag36h11(7))->covariance->isZero(0.0));
  const Pose T_ba = with.map.find(tag36h11(5))->T_map_tag;
  EXPECT_THAT(T_ba.inverse(), test::PoseNear(T_ab, 3e-5, 3e-5));
  const CalibrationResult without = calibrate(walls(), noisy_frames(1), {.held_tag = tag36h11(7)});
  EXPECT_LT(with.map.find(tag36h11(5))->covariance->trace(),
            0.1 * without.map.find(tag36h11(5))->covariance->trace());
  EXPECT_EQ(with.observations_used, without.observations_used) << "a constraint makes no view an outlier";
}

/// Of the distance between two tags, by what the result says of how they lie to each other.
double distance_variance_m2(const CalibrationResult& result, int a, int b) {
  const auto covariance =
      relative_covariance(result.map, result.evidence.joint, tag36h11(a), tag36h11(b)).value();
  const Pose T_a_b =
      result.map.find(tag36h11(a))->T_map_tag.inverse() * result.map.find(tag36h11(b))->T_map_tag;
  const Eigen::Vector3d along = T_a_b.rotation().conjugate() * T_a_b.translation().normalized();
  return along.dot(covariance.topLeftCorner<3, 3>() * along);
}

TEST(Constraints, LessenWhatIsOpenBetweenTheTagsThatTheyName) {
  constexpr double kSigma_m = 0.0003;
  const auto frames = noisy_frames(0);
  const double before = distance_variance_m2(calibrate(walls(), frames), 5, 19);
  const CalibrationOptions options{.constraints = {distance(5, 19, 0.0, kSigma_m)}};
  const double after = distance_variance_m2(calibrate(walls(), frames, options), 5, 19);
  EXPECT_GT(before, 2.0 * kSigma_m * kSigma_m) << "or there is nothing to lessen";
  EXPECT_NEAR(1.0 / after, 1.0 / before + 1.0 / (kSigma_m * kSigma_m), 0.01 / after);
}

/// Between the plane of three tags' centres and the normal of the first.
double angle_to_plane_rad(const TagMap& map, const std::array<int, 3>& ids) {
  std::array<Eigen::Vector3d, 3> centres;
  for (std::size_t i = 0; i < 3; ++i) centres[i] = map.find(tag36h11(ids[i]))->T_map_tag.translation();
  const Eigen::Vector3d across = (centres[1] - centres[0]).cross(centres[2] - centres[0]);
  const Eigen::Vector3d normal = map.find(tag36h11(ids[0]))->T_map_tag.rotation() * Eigen::Vector3d::UnitZ();
  return std::atan2(across.cross(normal).norm(), std::abs(across.dot(normal)));
}

TEST(Constraints, TagsOfOnePlaneAreFlat) {
  SyntheticWorld world = walls();
  for (MapTag& tag : world.map.tags) {  // three of them flat against one wall
    if (tag.key.id <= 7) tag.T_map_tag = test::looking_along(tag.T_map_tag.translation(), {0.0, -1.0, 0.0});
  }
  auto frames = test::exact_detections(world);
  RandomStream random(11);
  test::add_edge_noise(frames, 0.3, -0.45, random);
  const std::array<int, 3> ids = {3, 5, 7};
  const CalibrationResult without = calibrate(world, frames);
  const CalibrationResult with = calibrate(
      world, frames,
      {.constraints = {{.what = CoplanarConstraint{{tag36h11(3), tag36h11(5), tag36h11(7)}, 1e-4, 1e-4}}}});
  EXPECT_GT(angle_to_plane_rad(without.map, ids), 1e-3);
  EXPECT_LT(angle_to_plane_rad(with.map, ids), 2e-4);
  ASSERT_EQ(with.constraint_audits.size(), 1u);
  EXPECT_LT(*with.constraint_audits[0].z, 3.0);
}

/// Tags all round the room that a laser level put at one height: a plane across all of their normals.
TEST(Constraints, ALevelLineRoundTheRoomIsAPlane) {
  SyntheticWorld world = walls();
  std::vector<TagKey> all;
  for (MapTag& tag : world.map.tags) {
    Eigen::Vector3d place = tag.T_map_tag.translation();
    place.z() = 1.5;
    tag.T_map_tag = Pose(tag.T_map_tag.rotation(), place);
    all.push_back(tag.key);
  }
  auto frames = test::exact_detections(world);
  RandomStream random(13);
  test::add_edge_noise(frames, 0.15, -0.45, random);
  CalibrationOptions options{.constraints = {{.what = CoplanarConstraint{all, 1e-4, std::nullopt}}}};
  const CalibrationResult result = calibrate(world, frames, options);
  ASSERT_EQ(result.constraint_audits.size(), 1u);
  EXPECT_LT(*result.constraint_audits[0].z, 3.0);
  const Eigen::Vector3d up =
      world.map.find(result.held_tag)->T_map_tag.rotation().conjugate() * Eigen::Vector3d::UnitZ();
  for (const MapTag& tag : result.map.tags)
    EXPECT_NEAR(up.dot(tag.T_map_tag.translation()), 0.0, 0.02) << to_string(tag.key);

  // One of them 0.3 m higher: the words have a number though no single one is told by the others.
  for (MapTag& tag : world.map.tags) {
    if (tag.key == tag36h11(11))
      tag.T_map_tag =
          Pose(tag.T_map_tag.rotation(), tag.T_map_tag.translation() + Eigen::Vector3d(0.0, 0.0, 0.3));
  }
  frames = test::exact_detections(world);
  test::add_edge_noise(frames, 0.15, -0.45, random);
  EXPECT_THAT(error_of(ErrorKind::kNoResult, [&] { calibrate(world, frames, options); }),
              AllOf(HasSubstr("coplanar"), HasSubstr("sigmas off"), Not(HasSubstr(": :"))));
}

TEST(Constraints, ARowOfTagsTellsAPlaneByItsNormalsOnly) {
  std::vector<Pose> row, corner;
  for (const double x : {0.0, 1.0, 2.0, 3.0}) {
    row.emplace_back(Eigen::Quaterniond::Identity(), Eigen::Vector3d(x, 0.002 * x * x, 0.001 * x));
    corner.emplace_back(Eigen::Quaterniond::Identity(), Eigen::Vector3d(x, 0.2 * x * x, 0.1 * x));
  }
  const std::vector<int> all = {0, 1, 2, 3};
  EXPECT_TRUE(centres_of(all, row).are_in_line);
  EXPECT_FALSE(centres_of(all, corner).are_in_line);
}

TEST(Constraints, TheCovarianceOfAllTagsIsInTheMeasuredFrameToo) {
  const CalibrationOptions options{.constraints = {position(5, kNoError, 0.002), position(9, kNoError, 0.002),
                                                   position(15, kNoError, 0.002),
                                                   position(19, kNoError, 0.002)}};
  const CalibrationResult result = calibrate(walls(), noisy_frames(7), options);
  const JointCovariance& joint = result.evidence.joint;
  for (const MapTag& tag : result.map.tags) {
    const Eigen::Index row = *joint.row_of(tag.key);
    EXPECT_LT((joint.block(row, row) - *tag.covariance).norm(), 1e-6 * tag.covariance->norm())
        << to_string(tag.key);
  }
}

}  // namespace
}  // namespace apriltrack
