#include "apriltrack/tracker/paper_filter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apriltrack/base/check.h"
#include "apriltrack/base/error.h"
#include "apriltrack/filter/log_weights.h"
#include "apriltrack/filter/resample.h"
#include "apriltrack/geometry/rotation.h"

namespace apriltrack {
namespace {

constexpr std::size_t kMaxParticles = 10'000'000;

Eigen::Vector3d normal_vector(RandomStream& random, double sigma) {
  const double x = random.normal(), y = random.normal(), z = random.normal();
  return sigma * Eigen::Vector3d(x, y, z);
}

void require_sigma(const char* field, double sigma) {
  if (!(sigma >= 0.0 && std::isfinite(sigma)))
    throw invalid_input(field, fmt::format("must lie in [0, inf) (is {})", sigma));
}

/// Of T * exp(xi) = T_particle, xi = [translation; rotation] to first order, without exp's coupling of the
/// two.
Vector6d difference(const Pose& pose, const PaperState& particle) {
  const Eigen::Quaterniond to_pose = pose.rotation().conjugate();
  Vector6d xi;
  xi.head<3>() = to_pose * (particle.position - pose.translation());
  xi.tail<3>() = rotation_log(to_pose * particle.rotation);
  return xi;
}

}  // namespace

PaperState advance(const PaperState& state, const PaperNoise& noise, bool moves_with_new_velocity,
                   RandomStream& random) {
  PaperState next;
  next.velocity = state.velocity + normal_vector(random, noise.velocity_m);                            // (6)
  next.angular_velocity = state.angular_velocity + normal_vector(random, noise.angular_velocity_rad);  // (7)
  const Eigen::Vector3d& step = moves_with_new_velocity ? next.velocity : state.velocity;
  next.position = state.position + step + normal_vector(random, noise.position_m);  // (4)
  const Eigen::Quaterniond turned = state.rotation * rotation_exp(state.angular_velocity);
  next.rotation = (turned * rotation_exp(normal_vector(random, noise.rotation_rad))).normalized();  // (5)
  return next;
}

void PaperFilter::Options::check() const {
  if (num_particles < 1 || num_particles > kMaxParticles) {
    throw invalid_input("num_particles",
                        fmt::format("must lie in [1, {}] (is {})", kMaxParticles, num_particles));
  }
  require_sigma("noise position_m", noise.position_m);
  require_sigma("noise rotation_rad", noise.rotation_rad);
  require_sigma("noise velocity_m", noise.velocity_m);
  require_sigma("noise angular_velocity_rad", noise.angular_velocity_rad);
}

PaperFilter::PaperFilter(const Options& options) : options_(options) {
  options.check();
  start(Pose());
}

void PaperFilter::start(const Pose& pose) {
  PaperState state;
  state.position = pose.translation();
  state.rotation = pose.rotation();
  particles_.assign(options_.num_particles, state);
  weights_.assign(options_.num_particles, 1.0 / static_cast<double>(options_.num_particles));
}

void PaperFilter::advance() {
  ++frame_;
  const std::size_t count = particles_.size();
  RandomStream draws(options_.seed, frame_, count);  // a key that no particle has
  const std::vector<std::size_t> survivors = resample_multinomial(weights_, count, draws);
  std::vector<PaperState> moved;
  moved.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    RandomStream random(options_.seed, frame_, i);
    moved.push_back(apriltrack::advance(particles_[survivors[i]], options_.noise,
                                        options_.moves_with_new_velocity, random));
  }
  particles_ = std::move(moved);
  std::fill(weights_.begin(), weights_.end(), 1.0 / static_cast<double>(count));
}

void PaperFilter::weigh(std::span<const double> log_likelihoods) {
  APRILTRACK_CHECK(log_likelihoods.size() == particles_.size(), "one log-likelihood for each particle");
  weights_ = normalized_weights(log_likelihoods);
}

std::size_t PaperFilter::best() const {
  return static_cast<std::size_t>(std::max_element(weights_.begin(), weights_.end()) - weights_.begin());
}

Pose PaperFilter::mean() const {
  Pose pose = particles_[best()].pose();
  for (int iteration = 0; iteration < 3; ++iteration) {
    Vector6d step = Vector6d::Zero();
    for (std::size_t i = 0; i < particles_.size(); ++i) step += weights_[i] * difference(pose, particles_[i]);
    pose = Pose(pose.rotation() * rotation_exp(step.tail<3>()),
                pose.translation() + pose.rotation() * step.head<3>());
  }
  return pose;
}

Matrix6d PaperFilter::second_moment(const Pose& pose) const {
  Matrix6d moment = Matrix6d::Zero();
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    const Vector6d xi = difference(pose, particles_[i]);
    moment += weights_[i] * xi * xi.transpose();
  }
  return moment;
}

}  // namespace apriltrack
