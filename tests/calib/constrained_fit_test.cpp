#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "apriltrack/geometry/rotation.h"
#include "constraints/constrained_map.h"
#include "constraints/map_frame_start.h"
#include "model/corner_views.h"
#include "support/pose_matchers.h"
#include "synthetic_world.h"
#include "uncertainty/joint_tag_covariance.h"

// What is computed by low-rank updates, against the inverse of all equations at once.

namespace apriltrack {
namespace {

constexpr double kNoiseVariance = 2.3, kBiasVariance = 0.04;  // any

/// A small room as the images see it, and the dense equations of all of its poses.
struct SmallRoom {
  test::SyntheticWorld world = test::make_room(6, 16, test::equidistant_camera());
  Observations observations;
  std::vector<LinearView> views;
  ImageMap map;
  std::optional<PoseInformation> poses;
  std::map<int, Eigen::Index> offsets;  ///< Of tags, as PoseInformation has them.
  Eigen::MatrixXd covariance;           ///< Of the tags but the held one, together.

  SmallRoom() {
    auto frames = test::exact_detections(world);
    RandomStream random(41);
    test::add_edge_noise(frames, 0.15, -0.45, random);
    UnusedDetections unused;
    observations = collect_observations(frames, world.rig, world.sizes(), {}, unused);
    MapState state;
    for (const TagKey& tag : observations.tags) state.T_map_tag.push_back(world.map.find(tag)->T_map_tag);
    state.T_map_rig = world.T_world_rig;
    state.cameras = observations.cameras;
    move_origin_to(state, 0);
    std::vector<std::size_t> all(observations.views.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    views = corner_views(observations, all, state);
    map.keys = observations.tags;
    map.tags.resize(observations.tags.size());
    std::iota(map.tags.begin(), map.tags.end(), 0);
    map.T_held_tag = state.T_map_tag;
    poses = PoseInformation::of(views, map.tags, 0);
    for (std::size_t i = 1; i < map.tags.size(); ++i) offsets[map.tags[i]] = *poses->offset_of(map.tags[i]);
    covariance = dense_covariance();
    for (const int tag : map.tags) {
      const auto offset = offsets.find(tag);
      map.covariances.push_back(offset == offsets.end()
                                    ? Matrix6d::Zero()
                                    : Matrix6d(covariance.block<6, 6>(offset->second, offset->second)));
    }
  }

  CovarianceOperator joint() const {
    return {*poses, {.noise_variance = kNoiseVariance, .bias_variance = kBiasVariance}};
  }

  /// By the normal equations of all tags and frames at once.
  Eigen::MatrixXd dense_covariance() const {
    std::map<int, Eigen::Index> frames;
    for (const LinearView& view : views)
      frames.try_emplace(view.frame, poses->size() + 6 * static_cast<Eigen::Index>(frames.size()));
    const Eigen::Index size = poses->size() + 6 * static_cast<Eigen::Index>(frames.size());
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(size, size);
    std::map<int, Eigen::MatrixXd> by_errors;
    for (const LinearView& view : views) {
      Eigen::MatrixXd J = Eigen::MatrixXd::Zero(view.residual.size(), size);
      J.middleCols<6>(frames.at(view.frame)) = view.by_rig;
      if (const auto tag = offsets.find(view.tag); tag != offsets.end())
        J.middleCols<6>(tag->second) = view.by_tag;
      H += J.transpose() * J;
      by_errors.try_emplace(view.tag, Eigen::MatrixXd::Zero(size, 8)).first->second +=
          J.transpose() * view.by_error;
    }
    const Eigen::MatrixXd inverse = H.ldlt().solve(Eigen::MatrixXd::Identity(size, size));
    Eigen::MatrixXd result = kNoiseVariance * inverse;
    for (const auto& [tag, errors] : by_errors) {
      const Eigen::MatrixXd followed = inverse * errors;
      result += kBiasVariance * followed * followed.transpose();
    }
    return result.topLeftCorner(poses->size(), poses->size());
  }

  Pose truth(int tag) const { return world.map.find(map.keys[static_cast<std::size_t>(tag)])->T_map_tag; }
  TagKey key(int tag) const { return map.keys[static_cast<std::size_t>(tag)]; }

  /// Measured in the world, a little wrong; the frame is determined twice over.
  std::vector<MapConstraint> constraints() const {
    std::vector<MapConstraint> result;
    const auto position = [&](int tag, const Eigen::Vector3d& wrong_m) {
      const Eigen::Vector3d p = truth(tag).translation() + wrong_m;
      result.push_back({.what = PositionConstraint{key(tag), {p.x(), p.y(), p.z()}, 0.004}});
    };
    position(0, {0.002, -0.001, 0.003});
    position(2, {-0.003, 0.001, 0.002});
    position(5, {0.001, 0.004, -0.002});
    const double distance_m = (truth(1).translation() - truth(4).translation()).norm();
    result.push_back({.what = DistanceConstraint{key(1), key(4), distance_m + 0.002, 0.001}});
    const Pose T_ab = truth(1).inverse() * truth(3);
    result.push_back(
        {.what = RelativePoseConstraint{key(1), key(3), T_ab.translation(),
                                        T_ab.rotation() * rotation_exp({0.002, 0.0, -0.001}), 0.003, 0.004}});
    const Eigen::Vector3d down = truth(3).rotation().conjugate() * Eigen::Vector3d(0.002, 0.0, -1.0);
    result.push_back({.what = GravityConstraint{key(3), down, 0.003}});
    return result;
  }
};

const SmallRoom& small_room() {
  static const SmallRoom room;
  return room;
}

TEST(CovarianceOperator, IsThatOfAllEquationsAtOnce) {
  const SmallRoom& room = small_room();
  const Eigen::MatrixXd covariance =
      room.joint().times(Eigen::MatrixXd::Identity(room.poses->size(), room.poses->size()));
  EXPECT_LT((covariance - room.covariance).norm(), 1e-8 * room.covariance.norm());
}

/// Rows of all constraints by tags and frame, at the fit.
Eigen::MatrixXd dense_rows(const SmallRoom& room, const std::vector<MapConstraint>& constraints,
                           const ConstraintState& state, Eigen::VectorXd* residual = nullptr) {
  std::vector<std::pair<std::size_t, ConstraintAudit>> unused;
  const auto bound = bind_constraints(constraints, room.map, unused);
  Eigen::MatrixXd A(0, room.poses->size() + 6);
  Eigen::VectorXd r(0);
  for (const BoundConstraint& one : bound) {
    const LinearConstraint linear = linearise(one, state);
    const Eigen::Index first = A.rows(), rows = linear.residual.size();
    A.conservativeResize(first + rows, Eigen::NoChange);
    A.bottomRows(rows).setZero();
    for (std::size_t t = 0; t < one.tags.size(); ++t) {
      if (const auto offset = room.offsets.find(one.tags[t]); offset != room.offsets.end())
        A.block(first, offset->second, rows, 6) += linear.by_tag[t];
    }
    A.bottomRightCorner(rows, 6) = linear.by_frame;
    r.conservativeResize(first + rows);
    r.tail(rows) = linear.residual;
  }
  if (residual != nullptr) *residual = r;
  return A;
}

ConstraintState state_of(const SmallRoom& room, const ConstrainedMap& map) {
  ConstraintState state{room.map.T_held_tag, map.T_map_held, {}};
  for (std::size_t i = 0; i < state.T_held_tag.size(); ++i)
    state.T_held_tag[i] = map.T_map_held.inverse() * map.T_map_tag[i];
  return state;
}

/// Of tags and frame, given the images and the constraints.
Eigen::MatrixXd dense_posterior(const SmallRoom& room, const Eigen::MatrixXd& A) {
  Eigen::MatrixXd information = A.transpose() * A;
  information.topLeftCorner(room.poses->size(), room.poses->size()) += room.covariance.inverse();
  return information.inverse();
}

TEST(ConstrainedMap, PosesAndCovariancesAreThoseOfAllEquationsAtOnce) {
  const SmallRoom& room = small_room();
  const std::vector<MapConstraint> constraints = room.constraints();
  const ConstrainedMap map = constrain_map(constraints, room.map, room.joint());
  const ConstraintState state = state_of(room, map);
  Eigen::VectorXd residual;
  const Eigen::MatrixXd A = dense_rows(room, constraints, state, &residual);

  // At the minimum the gradient of images and constraints together vanishes.
  Eigen::VectorXd moved = Eigen::VectorXd::Zero(room.poses->size());
  for (const auto& [tag, offset] : room.offsets) {
    const auto t = static_cast<std::size_t>(tag);
    moved.segment<6>(offset) = (room.map.T_held_tag[t].inverse() * state.T_held_tag[t]).log();
  }
  Eigen::VectorXd gradient = A.transpose() * residual;
  const double scale = gradient.cwiseAbs().maxCoeff();
  gradient.head(moved.size()) += room.covariance.ldlt().solve(moved);
  EXPECT_GT(scale, 1.0);
  EXPECT_LT(gradient.cwiseAbs().maxCoeff(), 1e-5 * scale);

  const Eigen::MatrixXd posterior = dense_posterior(room, A);
  for (std::size_t i = 0; i < room.map.tags.size(); ++i) {
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(6, posterior.rows());  // of T_map_tag
    J.rightCols<6>() = state.T_held_tag[i].inverse().adjoint();
    if (const auto offset = room.offsets.find(room.map.tags[i]); offset != room.offsets.end())
      J.middleCols<6>(offset->second).setIdentity();
    const Matrix6d expected = J * posterior * J.transpose();
    EXPECT_LT((map.covariances[i] - expected).norm(), 1e-6 * expected.norm()) << i;
  }
}

/// Images moved by what an error of a tag does to them move the map to the minimum of all equations together.
TEST(ConstrainedMap, TellsNoiseAndWhatTagsKeepApart) {
  const SmallRoom& room = small_room();
  const std::vector<MapConstraint> constraints = room.constraints();
  const ConstrainedMap map = constrain_map(constraints, room.map, room.joint());
  const ConstraintState state = state_of(room, map);
  std::vector<TagKey> keys;
  for (const int tag : room.map.tags) keys.push_back(room.key(tag));
  const ErrorScale scale{.noise_variance = kNoiseVariance, .bias_variance = kBiasVariance};
  JointCovariance joint = joint_tag_covariance(*room.poses, room.map.tags, keys, scale, std::nullopt);
  const Eigen::MatrixXd followed_before = joint.by_errors;
  keep_to(map.change, joint);

  const Eigen::MatrixXd posterior = dense_posterior(room, dense_rows(room, constraints, state));
  const Eigen::Index size = room.poses->size();
  Eigen::MatrixXd pull = Eigen::MatrixXd::Zero(posterior.rows(), followed_before.cols());
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (const auto offset = room.offsets.find(room.map.tags[i]); offset != room.offsets.end())
      pull.middleRows<6>(offset->second) = followed_before.middleRows<6>(6 * static_cast<Eigen::Index>(i));
  }
  pull.topRows(size) = room.covariance.ldlt().solve(pull.topRows(size)).eval();
  const Eigen::MatrixXd moved = posterior * pull;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(6, posterior.rows());  // of T_map_tag
    J.rightCols<6>() = state.T_held_tag[i].inverse().adjoint();
    if (const auto offset = room.offsets.find(room.map.tags[i]); offset != room.offsets.end())
      J.middleCols<6>(offset->second).setIdentity();
    const Eigen::Index row = 6 * static_cast<Eigen::Index>(i);
    const Eigen::MatrixXd expected = J * moved;
    EXPECT_GT(expected.norm(), 0.0);
    EXPECT_LT((joint.by_errors.middleRows<6>(row) - expected).norm(), 1e-6 * expected.norm()) << i;
    EXPECT_LT((joint.block(row, row) - map.covariances[i]).norm(), 1e-6 * map.covariances[i].norm()) << i;
    EXPECT_GT((joint.by_noise.block<6, 6>(row, row).eigenvalues().real().minCoeff()), -1e-15);
  }
}

TEST(ConstrainedMap, AuditIsWhatAFitWithoutTheConstraintSays) {
  const SmallRoom& room = small_room();
  const std::vector<MapConstraint> constraints = room.constraints();
  const ConstrainedMap map = constrain_map(constraints, room.map, room.joint());
  ASSERT_EQ(map.audits.size(), constraints.size());
  for (std::size_t left_out = 0; left_out < constraints.size(); ++left_out) {
    SCOPED_TRACE(map.audits[left_out].title);
    std::vector<MapConstraint> others = constraints;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(left_out));
    const ConstraintState without = state_of(room, constrain_map(others, room.map, room.joint()));
    const Eigen::MatrixXd posterior = dense_posterior(room, dense_rows(room, others, without));
    Eigen::VectorXd error;
    const Eigen::MatrixXd own = dense_rows(room, {constraints[left_out]}, without, &error);
    const Eigen::MatrixXd covariance =
        own * posterior * own.transpose() + Eigen::MatrixXd::Identity(own.rows(), own.rows());
    const ConstraintAudit& audit = map.audits[left_out];
    ASSERT_EQ(audit.readings.size(), static_cast<std::size_t>(own.rows()));
    const double sigma = constraints[left_out].what.index() == 1 ? 0.001 : 0.003;
    for (std::size_t row = 0; row < audit.readings.size(); ++row) {
      const ConstraintReading& reading = audit.readings[row];
      ASSERT_TRUE(reading.sigma.has_value());
      const auto r = static_cast<Eigen::Index>(row);
      // The equations bend a little between the two fits.
      EXPECT_NEAR((*reading.predicted - reading.measured) / *reading.sigma,
                  error[r] / std::sqrt(covariance(r, r)), 0.01);
      EXPECT_GT(*reading.sigma, sigma);
    }
    if (own.rows() == 1) {
      EXPECT_NEAR(*audit.z, std::abs(error[0]) / std::sqrt(covariance(0, 0)), 0.01);
    }
  }
}

TEST(ConstrainedMap, WhatIsLeftOutOfADistanceAloneIsTheImages) {
  const SmallRoom& room = small_room();
  const double distance_m = (room.truth(1).translation() - room.truth(4).translation()).norm();
  const std::vector<MapConstraint> one = {
      {.what = DistanceConstraint{room.key(1), room.key(4), distance_m + 0.002, 0.001}}};
  const ConstrainedMap map = constrain_map(one, room.map, room.joint());
  EXPECT_EQ(map.gauge, "");
  EXPECT_EQ(map.T_map_held.matrix(), Pose().matrix());
  EXPECT_TRUE(map.covariances[0].isZero(0.0));  // the held tag
  ASSERT_TRUE(map.audits[0].readings[0].predicted.has_value());
  EXPECT_NEAR(*map.audits[0].readings[0].predicted, distance_m, 1e-6);  // but for what bends
  // It has moved towards what was measured, by its share of the variance.
  const double fitted_m = (map.T_map_tag[1].translation() - map.T_map_tag[4].translation()).norm();
  const double sigma_m = *map.audits[0].readings[0].sigma;
  EXPECT_NEAR(fitted_m - distance_m, 0.002 * (1.0 - 1e-6 / (sigma_m * sigma_m)), 1e-8);
}

/// The right answer from wherever the held tag hangs.
TEST(MapFrameStart, FindsTheFrameFromAnyOrientation) {
  const SmallRoom& room = small_room();
  for (std::uint64_t trial = 0; trial < 12; ++trial) {
    RandomStream random(17, trial);
    const Eigen::Quaterniond turn{random.normal(), random.normal(), random.normal(), random.normal()};
    const Pose T_measured_world(turn.normalized(), {100.0 * random.normal(), 1.0, -3e4});
    std::vector<MapConstraint> constraints;
    for (const int tag : {0, 2, 3, 5}) {
      const Eigen::Vector3d p = T_measured_world * room.truth(tag).translation();
      constraints.push_back({.what = PositionConstraint{room.key(tag), {p.x(), p.y(), p.z()}, 0.002}});
    }
    const ConstrainedMap map = constrain_map(constraints, room.map, room.joint());
    EXPECT_THAT(map.T_map_held, test::PoseNear(T_measured_world * room.truth(0), 1e-6, 1e-6)) << trial;
  }
}

TEST(MapFrameStart, GravityAloneLeavesHeadingAndOriginWithTheHeldTag) {
  const SmallRoom& room = small_room();
  const Eigen::Vector3d down = room.truth(4).rotation().conjugate() * -Eigen::Vector3d::UnitZ();
  const ConstrainedMap map =
      constrain_map(std::vector<MapConstraint>{{.what = GravityConstraint{room.key(4), down, 0.002}}},
                    room.map, room.joint());
  EXPECT_LT(map.T_map_held.translation().norm(), 1e-9);
  EXPECT_LT((map.T_map_tag[4].rotation() * down + Eigen::Vector3d::UnitZ()).norm(), 1e-9);
  EXPECT_EQ(map.gauge,
            "measured: gravity tag36h11/11; kept as with tag36h11/3 held at the origin: heading, x, y, z");
  EXPECT_FALSE(map.audits[0].z.has_value()) << "nothing else tells which way is down";
  // No claim about what was kept, sigma of the tilt in the rest: of the held tag the map's error is its own.
  const Eigen::Matrix3d R = map.T_map_held.rotation_matrix();
  const Eigen::Matrix3d tilt = R * map.covariances[0].bottomRightCorner<3, 3>() * R.transpose();
  EXPECT_NEAR(tilt(2, 2), 0.0, 1e-12);
  EXPECT_GT(std::sqrt(tilt(0, 0)), 0.002);
  EXPECT_LT(std::sqrt(tilt(0, 0)), 0.02);
  EXPECT_LT(map.covariances[0].topLeftCorner(3, 3).norm(), 1e-15);
}

TEST(MapFrameStart, DirectionsThatDisagreeTellNothingOfTheHeading) {
  const SmallRoom& room = small_room();
  std::vector<MapConstraint> constraints;
  for (const int tag : {0, 2, 4}) {
    Eigen::Vector3d down = room.truth(tag).rotation().conjugate() * -Eigen::Vector3d::UnitZ();
    if (tag == 2) down.x() += 0.08;
    constraints.push_back({.what = GravityConstraint{room.key(tag), down, 0.05}});
  }
  const ConstrainedMap map = constrain_map(constraints, room.map, room.joint());
  double largest_rad = 0.0;
  for (const ConstraintReading& reading : map.audits[1].readings)
    largest_rad = std::max(largest_rad, std::abs(*reading.predicted - reading.measured));
  EXPECT_NEAR(largest_rad, 0.08, 0.02) << "they must disagree";
  EXPECT_NE(map.gauge.find("origin: heading, x, y, z"), std::string::npos) << map.gauge;
  const Eigen::Matrix3d R = map.T_map_held.rotation_matrix();
  EXPECT_NEAR((R * map.covariances[0].bottomRightCorner<3, 3>() * R.transpose())(2, 2), 0.0, 1e-12);
}

TEST(MapFrameStart, OnePositionMovesTheMapAndDoesNotTurnIt) {
  const SmallRoom& room = small_room();
  const ConstrainedMap map = constrain_map(
      std::vector<MapConstraint>{{.what = PositionConstraint{room.key(3), {1.0, 2.0, 3.0}, 0.01}}}, room.map,
      room.joint());
  EXPECT_LT((map.T_map_tag[3].translation() - Eigen::Vector3d(1.0, 2.0, 3.0)).norm(), 1e-9);
  EXPECT_LT(rotation_angle_rad(map.T_map_held.rotation(), Eigen::Quaterniond::Identity()), 1e-12);
}

TEST(MapFrameStart, RefusesTwoFramesThatAgreeEquallyWell) {
  // Heights of three tags: the plane that they fix has two sides.
  const SmallRoom& room = small_room();
  std::vector<MapConstraint> constraints;
  for (const int tag : {0, 2, 5})
    constraints.push_back(
        {.what = PositionConstraint{
             room.key(tag), {std::nullopt, std::nullopt, room.truth(tag).translation().z()}, 0.002}});
  std::string message = "nothing was thrown";
  try {
    constrain_map(constraints, room.map, room.joint());
  } catch (const std::exception& error) {
    message = error.what();
  }
  EXPECT_NE(message.find("two map frames"), std::string::npos) << message;
  const Eigen::Vector3d down = room.truth(4).rotation().conjugate() * -Eigen::Vector3d::UnitZ();
  constraints.push_back({.what = GravityConstraint{room.key(4), down, 0.05}});
  const ConstrainedMap map = constrain_map(constraints, room.map, room.joint());
  EXPECT_NEAR(map.T_map_tag[3].translation().z(), room.truth(3).translation().z(), 1e-6);
  EXPECT_NE(map.gauge.find("heading, x, y"), std::string::npos) << map.gauge;
}

}  // namespace
}  // namespace apriltrack
