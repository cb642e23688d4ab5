#pragma once

#include <Eigen/Core>
#include <vector>

#include "apriltrack/geometry/pose.h"

namespace apriltrack {

/// A smooth path through given poses, with a continuous velocity.
///
/// Between two samples a cubic runs with the velocities of the samples; these are those of the parabola
/// through a sample and its two neighbours. Of rotations the cubic is one of rotation vectors, from the
/// sample before: R(t) = R_i exp(phi(t)), phi(t_i) = 0 (Kim, Kim and Shin, SIGGRAPH 1995, section 4, builds
/// curves in this way). Before the first sample and after the last, the path stands still.
class SampledPath {
 public:
  struct Sample {
    double time_s = 0.0;
    Pose pose;
  };

  /// Two samples or more, times strictly increasing; throws Error(kInvalidInput) that names the sample. Of
  /// neighbours, rotations must differ by less than 180 degrees: what lies between is the shorter way.
  explicit SampledPath(std::vector<Sample> samples);

  Pose at(double time_s) const;
  double start_s() const { return knots_.front().time_s; }
  double end_s() const { return knots_.back().time_s; }
  /// Of the steps from sample to sample.
  double median_step_s() const;
  double longest_step_s() const;

 private:
  std::vector<double> steps_s() const;

  struct Knot {
    double time_s = 0.0;
    Pose pose;
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // m/s, in the parent's frame
    Eigen::Vector3d spin = Eigen::Vector3d::Zero();      // rad/s, in the moving frame
  };
  std::vector<Knot> knots_;
};

}  // namespace apriltrack
