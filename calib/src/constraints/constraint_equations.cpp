#include "constraints/constraint_equations.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <variant>

#include "apriltrack/geometry/rotation.h"

namespace apriltrack {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Matrix2x3d = Eigen::Matrix<double, 2, 3>;
using Row = Eigen::MatrixXd::RowXpr;

const Vector3d kDown = -Vector3d::UnitZ();  // of the map

/// How many numbers a constraint tells.
struct RowCount {
  Eigen::Index operator()(const PositionConstraint& c) const {
    return std::ranges::count_if(c.position_m, [](const auto& one) { return one.has_value(); });
  }
  Eigen::Index operator()(const DistanceConstraint&) const { return 1; }
  Eigen::Index operator()(const RelativePoseConstraint& c) const { return c.orientation ? 6 : 3; }
  Eigen::Index operator()(const CoplanarConstraint& c) const {
    return static_cast<Eigen::Index>(c.tags.size()) * (c.sigma_rad ? 3 : 1);
  }
  Eigen::Index operator()(const UprightConstraint&) const { return 2; }
  Eigen::Index operator()(const FloorConstraint& c) const { return c.sigma_rad ? 3 : 1; }
  Eigen::Index operator()(const GravityConstraint&) const { return 2; }
  Eigen::Index operator()(const CameraGravityConstraint&) const { return 0; }
};

/// Collects the rows of one constraint.
class ConstraintRows {
 public:
  ConstraintRows(const BoundConstraint& bound, const ConstraintState& state) : bound_(bound), state_(state) {
    const Eigen::Index rows = num_rows(*bound.constraint);
    result_.residual.resize(rows);
    result_.by_tag.assign(bound.tags.size(), Eigen::MatrixXd::Zero(rows, 6));
    result_.by_frame = Eigen::MatrixXd::Zero(rows, 6);
    if (bound.plane >= 0) result_.by_plane = Eigen::MatrixXd::Zero(rows, kPlaneUnknowns);
  }

  void operator()(const PositionConstraint& c) {
    const Vector3d centre = state_.T_map_held * pose(0).translation();
    static constexpr const char* kNames[] = {"x", "y", "z"};
    for (int axis = 0; axis < 3; ++axis) {
      const auto& measured = c.position_m[static_cast<std::size_t>(axis)];
      if (!measured) continue;
      add({kNames[axis], "m", *measured, c.sigma_m}, centre[axis]);
      add_centre(0, Vector3d::Unit(axis), c.sigma_m);
    }
  }

  void operator()(const DistanceConstraint& c) {
    const Vector3d offset = pose(1).translation() - pose(0).translation();
    add({"distance", "m", c.distance_m, c.sigma_m}, offset.norm());
    const Vector3d direction = offset.norm() > 0.0 ? Vector3d(offset.normalized()) : Vector3d::UnitX();
    by_tag(0).leftCols<3>() = -direction.transpose() * pose(0).rotation_matrix() / c.sigma_m;
    by_tag(1).leftCols<3>() = direction.transpose() * pose(1).rotation_matrix() / c.sigma_m;
  }

  void operator()(const RelativePoseConstraint& c) {
    const Pose T_ab = pose(0).inverse() * pose(1);
    static constexpr const char* kNames[] = {"x", "y", "z"};
    for (int axis = 0; axis < 3; ++axis) {
      add({kNames[axis], "m", c.position_m[axis], c.sigma_m}, T_ab.translation()[axis]);
      by_tag(0).leftCols<3>() = -Matrix3d::Identity().row(axis) / c.sigma_m;
      by_tag(0).rightCols<3>() = skew(T_ab.translation()).row(axis) / c.sigma_m;
      by_tag(1).leftCols<3>() = T_ab.rotation_matrix().row(axis) / c.sigma_m;
    }
    if (!c.orientation) return;
    const Eigen::Quaterniond measured = c.orientation->normalized();
    const Vector3d turn = rotation_log(measured.conjugate() * T_ab.rotation());
    const Matrix3d by_right = rotation_left_jacobian_inverse(-turn);  // the right Jacobian's inverse
    static constexpr const char* kTurns[] = {"turn about x", "turn about y", "turn about z"};
    for (int axis = 0; axis < 3; ++axis) {
      add({kTurns[axis], "rad", 0.0, *c.sigma_rad}, turn[axis]);
      by_tag(0).rightCols<3>() = -(by_right * T_ab.rotation_matrix().transpose()).row(axis) / *c.sigma_rad;
      by_tag(1).rightCols<3>() = by_right.row(axis) / *c.sigma_rad;
    }
  }

  void operator()(const CoplanarConstraint& c) {
    const Pose& T_hp = state_.T_held_plane[static_cast<std::size_t>(bound_.plane)];
    const Pose T_ph = T_hp.inverse();
    for (std::size_t i = 0; i < bound_.tags.size(); ++i) {
      const Vector3d centre = T_ph * pose(i).translation();
      const Matrix3d R_pt = (T_ph * pose(i)).rotation_matrix();
      add({"height of " + name(i), "m", 0.0, c.sigma_m}, centre.z());
      by_tag(i).leftCols<3>() = R_pt.row(2) / c.sigma_m;
      // The centre moves in the plane's frame by -step z - turn x centre.
      by_plane() = Eigen::RowVector3d(-1.0, -centre.y(), centre.x()) / c.sigma_m;
      if (!c.sigma_rad) continue;
      Matrix2x3d by_turn;
      const Eigen::Vector2d error = direction_error(R_pt.col(2), Vector3d::UnitZ(), &by_turn);
      for (int row = 0; row < 2; ++row) {
        add({"tilt of " + name(i), "rad", 0.0, *c.sigma_rad}, error[row]);
        by_tag(i).rightCols<3>() = by_turn.row(row) * R_pt / *c.sigma_rad;
        by_plane().rightCols<2>() = -by_turn.row(row).leftCols<2>() / *c.sigma_rad;
      }
    }
  }

  void operator()(const UprightConstraint& c) { add_direction("tilt", Vector3d::UnitY(), c.sigma_rad); }

  void operator()(const FloorConstraint& c) {
    const Vector3d centre = state_.T_map_held * pose(0).translation();
    add({"height", "m", 0.0, c.sigma_m}, centre.z());
    add_centre(0, Vector3d::UnitZ(), c.sigma_m);
    if (c.sigma_rad) add_direction("tilt", Vector3d::UnitZ(), *c.sigma_rad);
  }

  void operator()(const GravityConstraint& c) {
    add_direction("tilt", c.direction_tag.stableNormalized(), c.sigma_rad);
  }

  /// Has become one of a tag's before: with_gravity_of_tags().
  void operator()(const CameraGravityConstraint&) {}

  LinearConstraint take() { return std::move(result_); }

 private:
  const Pose& pose(std::size_t i) const {
    return state_.T_held_tag[static_cast<std::size_t>(bound_.tags[i])];
  }
  std::string name(std::size_t i) const {
    const TagKey key = tags_of(*bound_.constraint)[i];
    return key.family.empty() ? std::to_string(key.id) : to_string(key);
  }

  /// The next row, whose derivatives are zero until they are told.
  void add(const ConstraintRow& row, double value) {
    row_ = static_cast<Eigen::Index>(result_.rows.size());
    result_.rows.push_back(row);
    result_.residual[row_] = (value - row.measured) / row.sigma;
  }
  // Of the row that was added last.
  Row by_tag(std::size_t i) { return result_.by_tag[i].row(row_); }
  Row by_frame() { return result_.by_frame.row(row_); }
  Row by_plane() { return result_.by_plane.row(row_); }

  /// Of a coordinate of a tag's centre in the map, along `axis`.
  void add_centre(std::size_t i, const Vector3d& axis, double sigma_m) {
    const Eigen::RowVector3d axis_held = axis.transpose() * state_.T_map_held.rotation_matrix();
    by_tag(i).leftCols<3>() = axis_held * pose(i).rotation_matrix() / sigma_m;
    by_frame().leftCols<3>() = axis_held / sigma_m;
    by_frame().rightCols<3>() = -axis_held * skew(pose(i).translation()) / sigma_m;
  }

  /// Two rows: a direction of the tag that points down in the map. In the tag's frame: turning the map about
  /// the vertical changes no residual, however large, and its heading stays open.
  void add_direction(const char* row_name, const Vector3d& direction_tag, double sigma_rad) {
    const Matrix3d R_held_tag = pose(0).rotation_matrix();
    const Vector3d down_tag = (state_.T_map_held.rotation_matrix() * R_held_tag).transpose() * kDown;
    Matrix2x3d by_turn;
    const Eigen::Vector2d error = direction_error(down_tag, direction_tag, &by_turn);
    for (int row = 0; row < 2; ++row) {
      add({row_name, "rad", 0.0, sigma_rad}, error[row]);
      by_tag(0).rightCols<3>() = -by_turn.row(row) / sigma_rad;
      by_frame().rightCols<3>() = -by_turn.row(row) * R_held_tag.transpose() / sigma_rad;
    }
  }

  const BoundConstraint& bound_;
  const ConstraintState& state_;
  LinearConstraint result_;
  Eigen::Index row_ = 0;
};

/// Two unit vectors across `target` and each other.
Matrix2x3d across(const Vector3d& target) {
  Matrix2x3d basis;
  const Vector3d other = std::abs(target.x()) < 0.7 ? Vector3d::UnitX() : Vector3d::UnitY();
  basis.row(0) = target.cross(other).normalized();
  basis.row(1) = target.cross(Vector3d(basis.row(0)));
  return basis;
}

}  // namespace

Eigen::Index num_rows(const MapConstraint& constraint) {
  return std::visit(RowCount(), constraint.what);
}

Pose moved_plane(const Pose& T_held_plane, const Eigen::Vector3d& step) {
  Vector6d xi = Vector6d::Zero();
  xi.segment<3>(2) = step;
  return T_held_plane * Pose::exp(xi);
}

Eigen::Vector2d direction_error(const Vector3d& direction, const Vector3d& target, Matrix2x3d* by_turn) {
  const Matrix2x3d basis = across(target);
  const Vector3d cross = target.cross(direction);
  const double sine = cross.norm(), cosine = target.dot(direction);
  const double angle = std::atan2(sine, cosine);
  if (sine < 1e-9) {
    if (by_turn != nullptr) *by_turn = basis;
    return cosine > 0.0 ? Eigen::Vector2d(basis * cross) : Eigen::Vector2d(angle, 0.0);
  }
  if (by_turn != nullptr) {
    // e = (angle / sine) cross, angle and sine functions of the cosine c; d direction = turn x direction.
    const double scale = angle / sine;
    const double scale_by_cosine =
        sine < 1e-4 && cosine > 0.0 ? -1.0 / 3.0 : (angle * cosine - sine) / (sine * sine * sine);
    const Eigen::RowVector3d cosine_by_turn = direction.cross(target).transpose();
    *by_turn = basis * (scale * -skew(target) * skew(direction) + scale_by_cosine * cross * cosine_by_turn);
  }
  return basis * cross * (angle / sine);
}

LinearConstraint linearise(const BoundConstraint& bound, const ConstraintState& state) {
  ConstraintRows rows(bound, state);
  std::visit(rows, bound.constraint->what);
  return rows.take();
}

}  // namespace apriltrack
