#include "apriltrack/sim/sampled_path.h"

#include <gmock/gmock.h>

#include <cmath>
#include <vector>

#include "apriltrack/geometry/rotation.h"
#include "support/error_message.h"

namespace apriltrack::test {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

/// A turn at constant spin along a parabola: what the path must follow exactly, whatever the samples' times
/// are.
Pose smooth(double time_s) {
  const Vector3d position(0.3 - 0.2 * time_s, 1.0 + 0.5 * time_s * time_s, -0.7 * time_s);
  return {rotation_exp({0.2, -0.1, 0.4}) * rotation_exp(time_s * Vector3d(0.9, -0.4, 0.6)), position};
}

SampledPath sampled(const std::vector<double>& times_s) {
  std::vector<SampledPath::Sample> samples;
  for (const double time_s : times_s) samples.push_back({time_s, smooth(time_s)});
  return SampledPath(samples);
}

TEST(SampledPath, FollowsAParabolaWithConstantSpin) {
  const SampledPath path = sampled({0.0, 0.1, 0.25, 0.3, 0.5, 0.9});
  constexpr double kMaxError = 1e-12;  // m, rad: rounding
  int count = 0;
  for (double time_s = 0.1; time_s <= 0.5; time_s += 0.01, ++count) {  // ends know one neighbour only
    const Pose error = smooth(time_s).inverse() * path.at(time_s);
    EXPECT_LT(error.translation().norm(), kMaxError) << time_s;
    EXPECT_LT(rotation_log(error.rotation()).norm(), kMaxError) << time_s;
  }
  EXPECT_GE(count, 40);
}

TEST(SampledPath, PassesThroughItsSamplesWithOneVelocity) {
  const std::vector<double> times_s = {0.0, 0.1, 0.2, 0.3, 0.4};
  const std::vector<Vector3d> turns = {
      {0, 0, 0}, {0.3, 0.2, 0}, {-0.4, 0.5, 1.1}, {0.1, 2.0, -0.3}, {0, 0, 0.2}};
  std::vector<SampledPath::Sample> samples;
  for (std::size_t i = 0; i < times_s.size(); ++i)
    samples.push_back({times_s[i], Pose(rotation_exp(turns[i]), turns[i].cwiseAbs2())});
  const SampledPath path(samples);
  constexpr double kStep_s = 1e-6;
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    const Pose error = samples[i].pose.inverse() * path.at(times_s[i]);
    EXPECT_LT(error.translation().norm() + rotation_log(error.rotation()).norm(), 1e-12);
    if (i == 0 || i + 1 == times_s.size()) continue;
    const auto rate = [&](double from_s) {  // twist over a short time, in the moving frame
      const Pose moved = path.at(from_s).inverse() * path.at(from_s + kStep_s);
      Vector3d spin = rotation_log(moved.rotation()) / kStep_s;
      return std::pair(Vector3d(path.at(from_s).rotation() * moved.translation() / kStep_s), spin);
    };
    const auto [velocity_before, spin_before] = rate(times_s[i] - kStep_s);
    const auto [velocity_after, spin_after] = rate(times_s[i]);
    EXPECT_LT((velocity_after - velocity_before).norm(), 2e-3) << i;  // m/s, of about 20; by the step
    EXPECT_LT((spin_after - spin_before).norm(), 2e-3) << i;          // rad/s
    EXPECT_GT(spin_after.norm(), 1.0);
  }
}

TEST(SampledPath, StandsStillBeforeAndAfter) {
  const SampledPath path = sampled({1.0, 1.2});
  EXPECT_EQ(path.at(-5.0).translation(), smooth(1.0).translation());
  EXPECT_EQ(path.at(7.0).translation(), smooth(1.2).translation());
  EXPECT_EQ(path.start_s(), 1.0);
  EXPECT_EQ(path.end_s(), 1.2);
}

TEST(SampledPath, KnowsItsSteps) {
  const SampledPath path = sampled({0.0, 0.1, 0.2, 0.7, 0.8});
  EXPECT_NEAR(path.median_step_s(), 0.1, 1e-12);
  EXPECT_NEAR(path.longest_step_s(), 0.5, 1e-12);
}

TEST(SampledPath, RefusesWhatIsNoPath) {
  const auto of_times = [](std::vector<double> times_s) { return [=] { sampled(times_s); }; };
  EXPECT_THAT(message_of(of_times({0.0})), HasSubstr("needs two poses or more (has 1)"));
  EXPECT_THAT(message_of(of_times({0.0, 1.0, 1.0})), HasSubstr("pose 3 is not later than the one before"));
  EXPECT_THAT(message_of(of_times({0.0, NAN})), HasSubstr("pose 2 is not later"));
}

}  // namespace
}  // namespace apriltrack::test
