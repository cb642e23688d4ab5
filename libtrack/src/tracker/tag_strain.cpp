#include "tag_strain.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>

#include "apriltrack/tags/tag_corners.h"
#include "pixels_by_pose.h"
#include "shared_error.h"

namespace apriltrack {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
/// Per axis, what a map made with care is off by: of the tag's size, and in direction. The paper curls, too.
constexpr double kMapShift = 0.015;
constexpr double kMapTurn_rad = 1.0 * kDegree;
/// A tag that was moved.
constexpr double kMovedShift = 0.25;
constexpr double kMovedTurn_rad = 15.0 * kDegree;
/// Of the state, where no tag tells: metres, radians, and those a second.
constexpr double kLeastInformation = 1e-2;

using PoseByState = Eigen::Matrix<double, 6, 12>;
using CornerJacobian = Eigen::Matrix<double, 2 * kNumCorners, 6>;

struct Equations {
  Matrix12d H = Matrix12d::Zero();
  Vector12d g = Vector12d::Zero();

  void add(const TagEquations& tag) {
    H += tag.H;
    g += tag.g;
  }
};

/// Of the corners in the image, by the left perturbation of the camera's view.
CornerJacobian corner_jacobian(const CameraModel& model, const MapTag& tag, const Pose& view) {
  CornerJacobian J = CornerJacobian::Zero();
  int row = 0;
  for (const Eigen::Vector3d& corner : corners_in_map(tag)) {
    if (const auto by_view = pixel_by_view(model, view, corner)) J.middleRows<2>(row) = *by_view;
    row += 2;
  }
  return J;
}

Matrix6d spread(double shift_m, double turn_rad) {
  Vector6d variance;
  variance << Eigen::Vector3d::Constant(shift_m * shift_m), Eigen::Vector3d::Constant(turn_rad * turn_rad);
  return variance.asDiagonal();
}

/// Frees the tag: the others and the state follow its going.
TagStrain strain_of(const PhotometricWorld& world, const Pose& view, const TagEquations& tag,
                    const Equations& all) {
  const Eigen::LDLT<Matrix12d> factor(all.H);
  const PoseByState coupling = tag.H.topRows<6>();
  const Matrix6d I = tag.H.topLeftCorner<6, 6>() - coupling * factor.solve(coupling.transpose());
  const Vector6d score = tag.g.head<6>() - coupling * factor.solve(all.g);

  const MapTag& mapped = world.tag_at(tag.evidence.tag_index).tag;
  const CornerJacobian J = corner_jacobian(world.model, mapped, view);
  const double sigma_px = usual_shared_sigma_px(tag.evidence.path_px);
  const Matrix6d in_camera = (view * mapped.T_map_tag).adjoint();
  const auto from_tag = [&](const Matrix6d& covariance) {
    return Matrix6d(in_camera * covariance * in_camera.transpose());
  };
  Matrix6d of_map = spread(kMapShift * mapped.size_m, kMapTurn_rad);
  if (mapped.covariance) of_map += *mapped.covariance;
  const Matrix6d ridge = 1e-6 * Matrix6d::Identity();
  // The others' share is about the tag's own.
  const Matrix6d shared =
      2.0 * (J.transpose() * J / (sigma_px * sigma_px) + ridge).inverse() + from_tag(of_map);
  const Eigen::LDLT<Matrix6d> variance(I + I * shared * I + ridge);

  TagStrain strain{.tag_index = tag.evidence.tag_index};
  strain.chi2 = score.dot(variance.solve(score));
  strain.shift_px = (J * (I + 1e3 * ridge).ldlt().solve(score)).norm() / std::sqrt(2.0 * kNumCorners);
  const Matrix6d moved = from_tag(spread(kMovedShift * mapped.size_m, kMovedTurn_rad));
  strain.power = (I * variance.solve(I) * moved).trace();
  return strain;
}

}  // namespace

std::vector<TagStrain> tag_strains(const PhotometricWorld& world, const MotionState& state,
                                   const std::vector<TagEquations>& tags) {
  const auto is_in_fit = [&](const TagEquations& tag) {
    return !world.tag_at(tag.evidence.tag_index).is_hidden;
  };
  Equations fit{.H = kLeastInformation * Matrix12d::Identity()};
  for (const TagEquations& tag : tags) {
    if (tag.evidence.is_explained() && is_in_fit(tag)) fit.add(tag);
  }
  const Pose view = camera_from_map(state.pose, world.mode);
  std::vector<TagStrain> strains;
  for (const TagEquations& tag : tags) {
    if (!tag.evidence.is_explained()) continue;
    Equations all = fit;
    if (!is_in_fit(tag)) all.add(tag);
    strains.push_back(strain_of(world, view, tag, all));
  }
  return strains;
}

}  // namespace apriltrack
