#include "apriltrack/tracker/paper_filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include "apriltrack/base/error.h"
#include "apriltrack/filter/log_weights.h"
#include "apriltrack/geometry/rotation.h"
#include "support/pose_matchers.h"

namespace apriltrack {
namespace {

using test::PoseNear;

const Pose kStart(rotation_exp({0.3, -0.2, 0.5}), {0.1, -0.2, 1.5});
const PaperNoise kNoNoise = {0.0, 0.0, 0.0, 0.0};

PaperState moving_state() {
  PaperState state;
  state.position = {0.1, 0.2, 0.9};
  state.velocity = {0.01, -0.02, 0.03};
  state.rotation = rotation_exp({0.2, 0.1, -0.3});
  state.angular_velocity = {0.02, 0.05, -0.04};
  return state;
}

PaperFilter filter_with(const PaperNoise& noise, std::size_t num_particles, std::uint64_t seed = 3) {
  PaperFilter::Options options;
  options.noise = noise;
  options.num_particles = num_particles;
  options.seed = seed;
  PaperFilter filter(options);
  filter.start(kStart);
  return filter;
}

TEST(PaperState, MovesOnAtConstantVelocity) {
  const PaperState start = moving_state();
  for (const bool moves_with_new_velocity : {false, true}) {
    PaperState state = start;
    RandomStream random(1);
    for (int i = 0; i < 10; ++i) state = advance(state, kNoNoise, moves_with_new_velocity, random);
    const Pose expected(start.rotation * rotation_exp(10.0 * start.angular_velocity),
                        start.position + 10.0 * start.velocity);
    EXPECT_THAT(state.pose(), PoseNear(expected, 1e-12, 1e-12));
    EXPECT_EQ(state.velocity, start.velocity);
    EXPECT_EQ(state.angular_velocity, start.angular_velocity);
  }
}

TEST(PaperState, MovesBeforeOrAfterTheNoiseOfItsVelocity) {
  const PaperNoise noise = {
      .position_m = 0.0, .rotation_rad = 0.0, .velocity_m = 0.5, .angular_velocity_rad = 0.7};
  const PaperState start = moving_state();
  RandomStream first(2), second(2);
  const PaperState printed = advance(start, noise, false, first);
  const PaperState program = advance(start, noise, true, second);
  EXPECT_GT((printed.velocity - start.velocity).norm(), 0.01);
  EXPECT_TRUE(printed.position.isApprox(start.position + start.velocity, 1e-12));
  EXPECT_TRUE(program.position.isApprox(start.position + program.velocity, 1e-12));
  // The rotation follows the old rate in both.
  for (const PaperState& state : {printed, program})
    EXPECT_LT(rotation_angle_rad(state.rotation, start.rotation * rotation_exp(start.angular_velocity)),
              1e-7);
}

TEST(PaperState, ReceivesTheNoiseAsked) {
  const PaperNoise noise = {
      .position_m = 0.01, .rotation_rad = 0.05, .velocity_m = 0.02, .angular_velocity_rad = 0.03};
  constexpr int kCount = 20000;  // standard error of a standard deviation: 0.5 %
  const PaperState start = moving_state();
  const PaperState expected = [&] {
    RandomStream unused(1);
    return advance(start, kNoNoise, false, unused);
  }();
  Eigen::Array3d position = Eigen::Array3d::Zero(), rotation = position, velocity = position, rate = position;
  for (int i = 0; i < kCount; ++i) {
    RandomStream random(4, 0, static_cast<std::uint64_t>(i));
    const PaperState next = advance(start, noise, false, random);
    position += (next.position - expected.position).array().square();
    rotation += rotation_log(expected.rotation.conjugate() * next.rotation).array().square();
    velocity += (next.velocity - start.velocity).array().square();
    rate += (next.angular_velocity - start.angular_velocity).array().square();
  }
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(std::sqrt(position[axis] / kCount), 0.01, 0.01 * 0.02);
    EXPECT_NEAR(std::sqrt(rotation[axis] / kCount), 0.05, 0.05 * 0.02);
    EXPECT_NEAR(std::sqrt(velocity[axis] / kCount), 0.02, 0.02 * 0.02);
    EXPECT_NEAR(std::sqrt(rate[axis] / kCount), 0.03, 0.03 * 0.02);
  }
}

TEST(PaperFilter, StartsWithAllParticlesAtThePose) {
  const PaperFilter filter = filter_with({}, 50);
  ASSERT_EQ(filter.particles().size(), 50U);
  for (const PaperState& particle : filter.particles())
    EXPECT_THAT(particle.pose(), PoseNear(kStart, 0.0, 1e-7));
  EXPECT_THAT(filter.mean(), PoseNear(kStart, 1e-12, 1e-7));
}

TEST(PaperFilter, ReportsTheSpreadOfItsCloud) {
  const PaperNoise noise = {
      .position_m = 0.01, .rotation_rad = 0.05, .velocity_m = 0.0, .angular_velocity_rad = 0.0};
  PaperFilter filter = filter_with(noise, 20000);
  filter.advance();
  EXPECT_THAT(filter.mean(), PoseNear(kStart, 5 * 0.01 / std::sqrt(20000.0), 5 * 0.05 / std::sqrt(20000.0)));
  Matrix6d expected = Matrix6d::Zero();
  expected.diagonal() << 1e-4, 1e-4, 1e-4, 2.5e-3, 2.5e-3, 2.5e-3;
  const Matrix6d about_mean = filter.second_moment(filter.mean());
  EXPECT_LT((about_mean - expected).cwiseAbs().maxCoeff(), 0.04 * 2.5e-3);
  EXPECT_NEAR(about_mean(0, 0), 1e-4, 0.04 * 1e-4);
  // About another pose, the offset comes on top (seen from that pose's own axes).
  const Pose shifted(kStart.rotation(),
                     kStart.translation() + kStart.rotation() * Eigen::Vector3d(0.2, 0, 0));
  EXPECT_NEAR(filter.second_moment(shifted)(0, 0), 1e-4 + 0.04, 2e-4);
}

TEST(PaperFilter, KeepsItsCloudWhereNothingIsKnown) {
  PaperFilter filter = filter_with({}, 1000);
  filter.advance();
  filter.weigh(std::vector<double>(1000, -std::numeric_limits<double>::infinity()));
  EXPECT_NEAR(effective_size(filter.weights()), 1000.0, 1e-6);
  // The original put all weight on the first particle, and the next frame's cloud was copies of that one.
  const double spread = filter.second_moment(filter.mean())(0, 0);
  filter.advance();
  EXPECT_GT(filter.second_moment(filter.mean())(0, 0), spread);
}

TEST(PaperFilter, DescendsFromWhatIsLikely) {
  PaperFilter filter = filter_with({.position_m = 0.1}, 200);
  filter.advance();
  std::vector<double> log_likelihoods(200, -1000.0);
  log_likelihoods[37] = 0.0;
  filter.weigh(log_likelihoods);
  EXPECT_EQ(filter.best(), 37U);
  const PaperState parent = filter.particles()[37];
  filter.advance();
  for (const PaperState& particle : filter.particles())
    EXPECT_LT((particle.position - parent.position - parent.velocity).norm(), 6 * 0.1);
  EXPECT_LT((filter.mean().translation() - parent.position - parent.velocity).norm(), 0.05);
}

TEST(PaperFilter, RepeatsItselfWithTheSameSeed) {
  PaperFilter a = filter_with({}, 100, 7), b = filter_with({}, 100, 7), c = filter_with({}, 100, 8);
  for (PaperFilter* filter : {&a, &b, &c}) {
    filter->advance();
    filter->advance();
  }
  for (std::size_t i = 0; i < 100; ++i) EXPECT_EQ(a.particles()[i].position, b.particles()[i].position);
  EXPECT_NE(a.particles()[0].position, c.particles()[0].position);
  std::set<double> distinct;
  for (const PaperState& particle : a.particles()) distinct.insert(particle.position.x());
  EXPECT_EQ(distinct.size(), 100U);
}

TEST(PaperFilter, RefusesOptionsOutOfRange) {
  PaperFilter::Options options;
  options.num_particles = 0;
  EXPECT_THROW(PaperFilter{options}, Error);
  options.num_particles = 10;
  options.noise.velocity_m = -0.1;
  EXPECT_THROW(PaperFilter{options}, Error);
}

}  // namespace
}  // namespace apriltrack
