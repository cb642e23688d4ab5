#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "apriltrack/base/random.h"
#include "apriltrack/geometry/pose.h"

namespace apriltrack {

/// The paper's state: 13 numbers, with time counted in frames.
struct PaperState {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();            ///< r, metres.
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();            ///< r dot, metres per frame, frame of r.
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  ///< q.
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();    ///< omega, radians per frame, body axes.

  Pose pose() const { return {rotation, position}; }
};

/// Standard deviations of the noise that each frame adds, per axis.
struct PaperNoise {
  double position_m = 0.01;
  double rotation_rad = 0.05;
  double velocity_m = 0.02;           ///< Per frame, and per frame again.
  double angular_velocity_rad = 0.0;  ///< Likewise.
};

/// One particle moved on by one frame: equations (4) to (7) of docs/algorithms/paper_filter.md.
/// moves_with_new_velocity: the position moves on with the velocity after its noise (the author's program),
/// or before (as printed).
PaperState advance(const PaperState& state, const PaperNoise& noise, bool moves_with_new_velocity,
                   RandomStream& random);

/// Sampling importance resampling over PaperState (docs/algorithms/paper_filter.md, section 2).
///
/// Random numbers are keyed by (seed, frame, particle). The state is a value: copying the filter forks it.
/// What is const may be called from several threads at once.
class PaperFilter {
 public:
  struct Options {
    std::size_t num_particles = 3000;
    PaperNoise noise;
    bool moves_with_new_velocity = false;
    std::uint64_t seed = 1;

    /// Throws Error(kInvalidInput) that names the field, its value and its range.
    void check() const;
  };

  explicit PaperFilter(const Options& options);

  /// All particles at `pose`, at rest.
  void start(const Pose& pose);
  /// Resamples by the weights, then moves every particle on by one frame.
  void advance();
  /// Weights from log-likelihoods, one for each particle; equal weights where none says anything.
  void weigh(std::span<const double> log_likelihoods);

  std::span<const PaperState> particles() const { return particles_; }
  std::span<const double> weights() const { return weights_; }  ///< Sum 1.
  /// The particle of the highest weight, the first of equals: the paper's answer.
  std::size_t best() const;
  /// Weighted mean; of rotations, the one about which the mean rotation vector vanishes.
  Pose mean() const;
  /// Weighted second moment about `pose`, of its right perturbation.
  Matrix6d second_moment(const Pose& pose) const;

 private:
  Options options_;
  std::uint64_t frame_ = 0;
  std::vector<PaperState> particles_;
  std::vector<double> weights_;
};

}  // namespace apriltrack
