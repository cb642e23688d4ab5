#pragma once

#include <Eigen/Cholesky>

#include "apriltrack/base/random.h"
#include "apriltrack/eval/corner_error.h"
#include "apriltrack/eval/trajectory.h"

namespace apriltrack::test {

inline Vector6d normal_vector(RandomStream& random, double sigma) {
  Vector6d v;
  for (int i = 0; i < 6; ++i) v(i) = sigma * random.normal();
  return v;
}

/// A full covariance with standard deviations about `sigma`.
inline Matrix6d random_covariance(RandomStream& random, double sigma) {
  Matrix6d root;
  for (int i = 0; i < 6; ++i) root.col(i) = normal_vector(random, sigma / 2.0);
  return root * root.transpose() + 0.1 * sigma * sigma * Matrix6d::Identity();
}

inline Vector6d sample(RandomStream& random, const Matrix6d& covariance) {
  return covariance.llt().matrixL() * normal_vector(random, 1.0);
}

/// A camera on a wide arc, turning as it goes.
inline Trajectory arc(int num_frames) {
  Trajectory trajectory;
  for (int i = 0; i < num_frames; ++i) {
    const double a = 0.1 * i;
    Vector6d turn;
    turn << 0, 0, 0, 0.3 * std::sin(a), 0.2 * std::cos(2 * a), 0.5 * a;
    const Eigen::Vector3d place(2 * std::cos(a), std::sin(a), 0.3 * std::sin(3 * a));
    trajectory.push_back({{1'000'000'000 + i * 33'333'333LL}, Pose(Pose::exp(turn).rotation(), place)});
  }
  return trajectory;
}

inline MapTag tag_at(int id, const Pose& T_map_tag, double size_m = 0.2) {
  MapTag tag;
  tag.key.id = id;
  tag.size_m = size_m;
  tag.T_map_tag = T_map_tag;
  return tag;
}

}  // namespace apriltrack::test
