#include "apriltrack/sim/sampled_path.h"

#include <fmt/format.h>

#include <algorithm>

#include "apriltrack/base/error.h"
#include "apriltrack/geometry/rotation.h"

namespace apriltrack {
namespace {

using Eigen::Vector3d;

/// Rotation vector from one rotation to the other, in the first one's frame.
Vector3d turn(const Pose& from, const Pose& to) {
  return rotation_log(from.rotation().conjugate() * to.rotation());
}

/// The velocity at a sample, by the mean velocities of the intervals before and after it: that of the
/// parabola through the three samples.
Vector3d velocity_between(const Vector3d& before, double before_s, const Vector3d& after, double after_s) {
  return (after_s * before + before_s * after) / (before_s + after_s);
}

/// The cubic with value 0 at 0 and `end` at 1, and these slopes there.
Vector3d cubic(double u, const Vector3d& end, const Vector3d& slope_0, const Vector3d& slope_1) {
  return u * (1 - u) * (1 - u) * slope_0 + u * u * (3 - 2 * u) * end + u * u * (u - 1) * slope_1;
}

void check_samples(const std::vector<SampledPath::Sample>& samples) {
  if (samples.size() < 2)
    throw invalid_input("trajectory", fmt::format("needs two poses or more (has {})", samples.size()));
  for (std::size_t i = 1; i < samples.size(); ++i) {
    if (!(samples[i].time_s > samples[i - 1].time_s))
      throw invalid_input("trajectory", fmt::format("pose {} is not later than the one before ({} s, {} s)",
                                                    i + 1, samples[i].time_s, samples[i - 1].time_s));
  }
}

}  // namespace

SampledPath::SampledPath(std::vector<Sample> samples) {
  check_samples(samples);
  for (const Sample& sample : samples) knots_.push_back({.time_s = sample.time_s, .pose = sample.pose});
  const std::size_t last = knots_.size() - 1;
  const auto interval_s = [&](std::size_t i) { return knots_[i + 1].time_s - knots_[i].time_s; };
  const auto velocity = [&](std::size_t i) -> Vector3d {
    return (knots_[i + 1].pose.translation() - knots_[i].pose.translation()) / interval_s(i);
  };
  const auto spin = [&](std::size_t i) -> Vector3d {
    return turn(knots_[i].pose, knots_[i + 1].pose) / interval_s(i);
  };
  for (std::size_t i = 0; i <= last; ++i) {
    const std::size_t before = i > 0 ? i - 1 : 0;
    const std::size_t after = std::min(i, last - 1);
    knots_[i].velocity =
        velocity_between(velocity(before), interval_s(before), velocity(after), interval_s(after));
    knots_[i].spin = velocity_between(spin(before), interval_s(before), spin(after), interval_s(after));
  }
}

std::vector<double> SampledPath::steps_s() const {
  std::vector<double> steps;
  for (std::size_t i = 1; i < knots_.size(); ++i) steps.push_back(knots_[i].time_s - knots_[i - 1].time_s);
  return steps;
}

double SampledPath::median_step_s() const {
  std::vector<double> steps = steps_s();
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::ranges::nth_element(steps, middle);
  return *middle;
}

double SampledPath::longest_step_s() const {
  return std::ranges::max(steps_s());
}

Pose SampledPath::at(double time_s) const {
  if (time_s <= start_s()) return knots_.front().pose;
  if (time_s >= end_s()) return knots_.back().pose;
  const auto later = std::ranges::upper_bound(knots_, time_s, {}, &Knot::time_s);
  const Knot& b = *later;
  const Knot& a = *(later - 1);
  const double interval_s = b.time_s - a.time_s;
  const double u = (time_s - a.time_s) / interval_s;
  const Vector3d moved =
      cubic(u, b.pose.translation() - a.pose.translation(), interval_s * a.velocity, interval_s * b.velocity);
  // At the end, spin = J_r(phi) dphi/dt, and the right Jacobian of phi is the left one of -phi.
  const Vector3d whole_turn = turn(a.pose, b.pose);
  const Vector3d slope_1 = rotation_left_jacobian_inverse(-whole_turn) * (interval_s * b.spin);
  const Vector3d turned = cubic(u, whole_turn, interval_s * a.spin, slope_1);
  return {a.pose.rotation() * rotation_exp(turned), a.pose.translation() + moved};
}

}  // namespace apriltrack
