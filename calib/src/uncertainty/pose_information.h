#pragma once

#include <Eigen/Cholesky>
#include <map>
#include <optional>
#include <vector>

#include "numerics/linear_view.h"

namespace apriltrack {

/// How the residual of one view depends on parameters other than the poses (a lens, a size).
struct ParameterView {
  std::size_t view = 0;  ///< Into the views that the information was made from.
  Eigen::MatrixXd by_parameter;
  Eigen::Index first = 0;  ///< Of the parameters that the view depends on, side by side.
};

/// Of the same views, each of which depends on all of them; either may be empty.
std::vector<ParameterView> beside(std::vector<ParameterView> some, const std::vector<ParameterView>& more);

/// What the views say of such parameters when all poses follow them: the normal equations
/// information * parameters = -gradient that are left when the poses are eliminated.
struct ParameterInformation {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;
  /// How the poses follow: a column per parameter, rows as PoseInformation::offset_of() says.
  Eigen::MatrixXd poses_by_parameter;
  /// By the eight errors that each tag keeps in all of its views.
  std::map<int, Eigen::MatrixXd> gradient_by_errors;
};

/// The normal equations of all poses but the held tag's, frames eliminated one by one (Schur complement) and
/// the system of the tags factored: one dense matrix of six rows per tag, and a block for each two tags that
/// a frame shows together. (docs/algorithms/calibration.md, equations 7 and 10.)
class PoseInformation {
 public:
  using Matrix6x8d = Eigen::Matrix<double, 6, 8>;
  using Blocks = std::map<Eigen::Index, Matrix6x8d>;  ///< By offset.

  /// Of `tags`. nullopt when the views leave a pose undetermined. Refers to `views`.
  static std::optional<PoseInformation> of(const std::vector<LinearView>& views, const std::vector<int>& tags,
                                           int held_tag);

  /// Where the six rows of a tag start in the system; nullopt for the held one.
  std::optional<Eigen::Index> offset_of(int tag) const;
  Eigen::Index size() const { return scale_.size(); }
  /// The system's inverse times `columns`.
  Eigen::MatrixXd solve(Eigen::MatrixXd columns) const;
  /// Keeps the inverse: with it each further elimination costs only the rows of the tags that it concerns.
  /// Worth it before many.
  void invert() { inverse_ = solve(Eigen::MatrixXd::Identity(size(), size())); }
  /// The system's right side, negative, by the eight errors that a tag keeps in all of its views.
  const std::map<int, Blocks>& by_errors() const { return by_errors_; }

  /// How all poses follow the errors that one tag keeps: eight columns, rows as offset_of() says.
  Eigen::MatrixXd poses_by_errors(int tag) const;
  /// How a frame's pose follows them. poses: of poses_by_errors(tag).
  Matrix6x8d frame_by_errors(int frame, int tag, const Eigen::MatrixXd& poses) const;

  ParameterInformation eliminate_poses(const std::vector<ParameterView>& columns) const;

 private:
  /// One frame's own normal equations, and for each tag that it shows their coupling and the frame's
  /// sensitivity to errors of that tag.
  struct Frame {
    struct OfTag {
      Matrix6d tag_rig = Matrix6d::Zero();
      Matrix6x8d rig_errors = Matrix6x8d::Zero();
    };
    Matrix6d rig_rig = Matrix6d::Zero();
    Vector6d gradient = Vector6d::Zero();
    std::map<int, OfTag> tags;
    Eigen::LDLT<Matrix6d> factor;
  };

  explicit PoseInformation(const std::vector<LinearView>& views) : views_(&views) {}
  void number_tags(const std::vector<int>& tags, int held_tag);
  /// The tags' own blocks and the frames', not yet eliminated.
  Eigen::MatrixXd collect();
  void eliminate(const Frame& frame, Eigen::MatrixXd& reduced);
  bool factorise(Eigen::MatrixXd& reduced);
  /// J_rig' times the parameters' columns, by frame and the first of the parameters.
  using FrameColumns = std::map<int, std::map<Eigen::Index, Eigen::MatrixXd>>;
  FrameColumns frames_by_parameter(const std::vector<ParameterView>& columns) const;
  /// The system's inverse times columns of which most rows are 0.
  Eigen::MatrixXd solve_sparse(const Eigen::MatrixXd& columns) const;
  void add_errors(const std::vector<ParameterView>& columns, const FrameColumns& by_frame,
                  ParameterInformation& result) const;

  const std::vector<LinearView>* views_;
  std::map<int, Eigen::Index> offsets_;
  std::map<int, Frame> frames_;
  std::map<int, Blocks> by_errors_;
  Eigen::VectorXd gradient_;  ///< Of the reduced system.
  Eigen::VectorXd scale_;     ///< Makes the system's diagonal one.
  Eigen::LLT<Eigen::MatrixXd> factor_;
  Eigen::MatrixXd inverse_;  ///< Empty, or of the whole system.
};

}  // namespace apriltrack
