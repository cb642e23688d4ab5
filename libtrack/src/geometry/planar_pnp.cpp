#include "apriltrack/geometry/planar_pnp.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "apriltrack/base/check.h"
#include "apriltrack/geometry/homography.h"
#include "apriltrack/geometry/rotation.h"
#include "apriltrack/geometry/tag_corners.h"
#include "apriltrack/geometry/tag_view.h"

namespace apriltrack {
namespace {

using Corners = std::array<Eigen::Vector3d, 4>;
using Corners2d = std::array<Eigen::Vector2d, 4>;

constexpr int kMaxIterations = 60;
constexpr double kStepTolerance = 1e-13;  // relative to the distance, and in radians
constexpr double kMaxDamping = 1e8;       // no step lowers the error any more: rounding
constexpr double kMinDepth = 1e-3;        // cosine to the mean ray: within a hemisphere
constexpr double kMinCornerArea = 1e-9;   // of a corner's parallelogram, over the quad's squared extent
constexpr double kSamePose_rad = 1e-4;    // refined minima agree to 1e-7 where they are one
constexpr double kSamePoseRelative = 1e-4;

/// A rotation that turns `ray` into the z axis: by the quaternion half way; a ray that points backwards is
/// turned by half a turn about x before.
Eigen::Matrix3d turn_to_axis(const Eigen::Vector3d& ray) {
  const Eigen::Vector3d half_turn(1.0, ray.z() < 0.0 ? -1.0 : 1.0, ray.z() < 0.0 ? -1.0 : 1.0);
  const Eigen::Vector3d d = half_turn.asDiagonal() * ray.normalized();
  const Eigen::Quaterniond shortest(1.0 + d.z(), d.y(), -d.x(), 0.0);
  return shortest.normalized().toRotationMatrix() * half_turn.asDiagonal();
}

/// Of a 2x2 matrix, in closed form.
struct Stretch {
  double larger = 0.0;  ///< Singular values.
  double smaller = 0.0;
  Eigen::Vector2d along_smaller;  ///< Its right singular vector.
};

Stretch stretch_of(const Eigen::Matrix2d& m) {
  const double a = m.col(0).squaredNorm(), b = m.col(0).dot(m.col(1)), c = m.col(1).squaredNorm();
  const double larger = std::sqrt(0.5 * (a + c) + std::hypot(0.5 * (a - c), b));
  const double angle = 0.5 * std::atan2(2.0 * b, a - c);  // of the larger one's right singular vector
  return {larger, std::abs(m.determinant()) / larger, {-std::sin(angle), std::cos(angle)}};
}

/// The rays' points on the plane z = 1 of a camera turned to look along their mean.
std::optional<Corners2d> image_points(const Corners& rays, const Eigen::Matrix3d& R_view_camera) {
  Corners2d points;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Eigen::Vector3d ray_view = R_view_camera * rays[i];
    if (!(ray_view.z() > kMinDepth)) return std::nullopt;
    points[i] = ray_view.hnormalized();
  }
  return points;
}

/// A square's face seen from the front shows its corners as a convex quad that turns one way: with y down,
/// ours has a negative cross product at every corner. Collinear, coincident, crossed and mirrored corners
/// fail.
bool is_front_view(const Corners2d& p) {
  double extent_squared = 0.0;
  for (const Eigen::Vector2d& q : p) extent_squared = std::max(extent_squared, (q - p[0]).squaredNorm());
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Eigen::Vector2d in = p[(i + 1) % 4] - p[i];
    const Eigen::Vector2d out = p[(i + 2) % 4] - p[(i + 1) % 4];
    if (!(in.x() * out.y() - in.y() * out.x() < -kMinCornerArea * extent_squared)) return false;
  }
  return extent_squared > 0.0;
}

/// Both poses whose plane-to-image map has the homography's value and derivative at the tag's centre.
///
/// Turn the camera so that the centre lies on its axis. There the derivative of (x/z, y/z) by the plane's
/// coordinates is R22 / distance, R22 the rotation's upper left block, whose larger singular value is 1: that
/// gives the distance. The third row (r31, r32) completes R22' R22 to the identity, up to its sign: the
/// ambiguity.
std::array<Pose, 2> poses_at_centre(const Eigen::Matrix3d& H_view_plane,
                                    const Eigen::Matrix3d& R_view_camera) {
  const Eigen::Matrix3d R_axis_view = turn_to_axis(H_view_plane.col(2));
  const Eigen::Matrix3d H = R_axis_view * H_view_plane;
  const Eigen::Matrix2d derivative = H.topLeftCorner<2, 2>() / H(2, 2);
  const Stretch stretch = stretch_of(derivative);
  const double distance = 1.0 / stretch.larger;
  const double ratio = stretch.smaller * distance;
  const Eigen::Vector2d row = std::sqrt(std::max(0.0, 1.0 - ratio * ratio)) * stretch.along_smaller;
  const Eigen::Matrix3d R_camera_axis = (R_axis_view * R_view_camera).transpose();

  std::array<Pose, 2> poses;
  for (std::size_t i = 0; i < 2; ++i) {
    Eigen::Matrix3d R;
    R.topLeftCorner<2, 2>() = distance * derivative;
    R.bottomLeftCorner<1, 2>() = (i == 0 ? row : -row).transpose();
    R.col(2) = R.col(0).cross(R.col(1));
    poses[i] = Pose(Eigen::Matrix3d(R_camera_axis * R), R_camera_axis * Eigen::Vector3d(0.0, 0.0, distance));
  }
  return poses;
}

/// The same view with the tag mirrored about the line of sight to its centre: a start near the other minimum.
Pose mirrored(const Pose& T_camera_tag) {
  const Eigen::Matrix3d R_axis_camera = turn_to_axis(T_camera_tag.translation());
  const Eigen::Vector3d flip(1.0, 1.0, -1.0);
  const Eigen::Matrix3d R_axis_tag = R_axis_camera * T_camera_tag.rotation_matrix();
  return Pose(
      Eigen::Matrix3d(R_axis_camera.transpose() * (flip.asDiagonal() * R_axis_tag * flip.asDiagonal())),
      T_camera_tag.translation());
}

/// Angular errors of the four corners in the tangent planes of their rays, and their Jacobian.
class RayProblem {
 public:
  RayProblem(const Corners& rays, double size_m) : corners_tag_(tag_corners(size_m)) {
    for (std::size_t i = 0; i < rays.size(); ++i) tangents_[i] = turn_to_axis(rays[i]).topRows<2>();
    for (std::size_t i = 0; i < rays.size(); ++i) rays_[i] = rays[i];
  }

  double squared_error(const Pose& T_camera_tag) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < 4; ++i)
      sum += (tangents_[i] * (T_camera_tag * corners_tag_[i]).normalized()).squaredNorm();
    return sum;
  }

  /// Normal equations for the right perturbation of T_camera_tag.
  void linearise(const Pose& T_camera_tag, Matrix6d* hessian, Vector6d* gradient) const {
    hessian->setZero();
    gradient->setZero();
    const Eigen::Matrix3d R = T_camera_tag.rotation_matrix();
    for (std::size_t i = 0; i < 4; ++i) {
      const Eigen::Vector3d point = T_camera_tag * corners_tag_[i];
      const Eigen::Vector3d direction = point.normalized();
      const Eigen::Matrix3d d_direction =
          (Eigen::Matrix3d::Identity() - direction * direction.transpose()) / point.norm();
      Eigen::Matrix<double, 3, 6> d_point;
      d_point << R, -R * skew(corners_tag_[i]);
      const Eigen::Matrix<double, 2, 6> jacobian = tangents_[i] * d_direction * d_point;
      *hessian += jacobian.transpose() * jacobian;
      *gradient += jacobian.transpose() * (tangents_[i] * direction);
    }
  }

  /// Every corner on its ray's side of the eye, and the face, not the back, towards it.
  bool is_seen(const Pose& T_camera_tag) const {
    for (std::size_t i = 0; i < 4; ++i) {
      if (!((T_camera_tag * corners_tag_[i]).dot(rays_[i]) > 0.0)) return false;
    }
    return tag_view_cosine(T_camera_tag) > 0.0;
  }

 private:
  Corners corners_tag_;
  Corners rays_;
  std::array<Eigen::Matrix<double, 2, 3>, 4> tangents_;
};

/// Levenberg-Marquardt with damping in proportion to the diagonal, so that metres and radians need no
/// weighing.
PlanarPose refine(const RayProblem& problem, Pose T_camera_tag) {
  double error = problem.squared_error(T_camera_tag);
  double damping = 1e-6;
  for (int i = 0; i < kMaxIterations && damping < kMaxDamping; ++i) {
    Matrix6d hessian;
    Vector6d gradient;
    problem.linearise(T_camera_tag, &hessian, &gradient);
    hessian.diagonal() *= 1.0 + damping;
    const Vector6d step = -hessian.ldlt().solve(gradient);
    const Pose candidate = T_camera_tag * Pose::exp(step);
    const double candidate_error = problem.squared_error(candidate);
    if (!(candidate_error <= error)) {
      damping *= 10.0;
      continue;
    }
    T_camera_tag = candidate;
    error = candidate_error;
    damping = std::max(1e-12, 0.1 * damping);
    const double relative_step =
        step.head<3>().norm() / T_camera_tag.translation().norm() + step.tail<3>().norm();
    if (relative_step < kStepTolerance) break;
  }
  return {T_camera_tag, std::sqrt(error / 8.0)};
}

bool coincide(const Pose& a, const Pose& b) {
  return rotation_angle_rad(a.rotation(), b.rotation()) < kSamePose_rad &&
         (a.translation() - b.translation()).norm() < kSamePoseRelative * a.translation().norm();
}

}  // namespace

void PlanarPoses::insert(const PlanarPose& pose) {
  for (std::size_t i = 0; i < size_; ++i) {
    if (!coincide(poses_[i].T_camera_tag, pose.T_camera_tag)) continue;
    if (pose.rms_error_rad < poses_[i].rms_error_rad) poses_[i] = pose;
    if (size_ == 2 && poses_[1].rms_error_rad < poses_[0].rms_error_rad) std::swap(poses_[0], poses_[1]);
    return;
  }
  if (size_ < poses_.size()) {
    poses_[size_++] = pose;
  } else if (pose.rms_error_rad < poses_.back().rms_error_rad) {
    poses_.back() = pose;
  }
  if (size_ == 2 && poses_[1].rms_error_rad < poses_[0].rms_error_rad) std::swap(poses_[0], poses_[1]);
}

PlanarPoses solve_planar_pnp(const std::array<Eigen::Vector3d, 4>& rays_camera, double size_m) {
  APRILTRACK_CHECK(std::isfinite(size_m) && size_m > 0.0, "a tag's size must be positive");
  const Eigen::Vector3d mean_ray = rays_camera[0] + rays_camera[1] + rays_camera[2] + rays_camera[3];
  if (!mean_ray.allFinite() || !(mean_ray.norm() > kMinDepth)) return {};
  const Eigen::Matrix3d R_view_camera = turn_to_axis(mean_ray);
  const auto points_view = image_points(rays_camera, R_view_camera);
  if (!points_view || !is_front_view(*points_view)) return {};

  const Corners corners_tag = tag_corners(size_m);
  Corners2d corners_plane;
  for (std::size_t i = 0; i < 4; ++i) corners_plane[i] = corners_tag[i].head<2>();
  const auto H_view_plane = estimate_homography(corners_plane, *points_view);
  if (!H_view_plane) return {};

  const RayProblem problem(rays_camera, size_m);
  PlanarPoses poses;
  const auto consider = [&](const Pose& start) {
    if (!start.is_finite()) return;
    const PlanarPose pose = refine(problem, start);
    if (pose.T_camera_tag.is_finite() && std::isfinite(pose.rms_error_rad) &&
        problem.is_seen(pose.T_camera_tag)) {
      poses.insert(pose);
    }
  };
  for (const Pose& start : poses_at_centre(*H_view_plane, R_view_camera)) consider(start);
  // With noise both starts can slide into one minimum; the mirror image of what was found reaches the other.
  if (poses.size() == 1) consider(mirrored(poses[0].T_camera_tag));
  return poses;
}

}  // namespace apriltrack
