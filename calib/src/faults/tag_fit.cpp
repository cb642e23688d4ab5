#include "faults/tag_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "apriltrack/camera/pixel_jacobian.h"
#include "numerics/cauchy_loss.h"
#include "uncertainty/noise_scale.h"

namespace apriltrack {
namespace {

// Scales of Cauchy's loss on a view's whitened norm; a good one's is sqrt(8).
constexpr double kProbeLoss = 8.0, kCoarseProbeLoss = 100.0;
constexpr double kUnseenCost = 400.0;
// Of Student's distribution of eight numbers, and less than its logarithm by so much that the mean is
// usual_probe_cost(): (4 + 8) / 2 (digamma(6) - digamma(2)) = 7.70.
constexpr double kTailPower = 0.5 * (kTailFreedom + 8.0), kTailOffset = 3.93;
constexpr int kMaxTagSteps = 30;
constexpr std::size_t kMaxProposals = 8;

using Matrix8x9d = Eigen::Matrix<double, 8, 9>;
using Vector9d = Eigen::Matrix<double, 9, 1>;
using Matrix9d = Eigen::Matrix<double, 9, 9>;

/// Residual of a tag of any shape, whitened; and its derivatives by the pose and by the shape's three
/// numbers.
bool probe_residual(const ProbeView& probe, const Pose& T_map_tag, const TagShape& shape, Vector8d* residual,
                    Matrix8x9d* jacobian) {
  const Pose T_camera_tag = probe.camera->T_camera_rig * probe.T_map_rig.inverse() * T_map_tag;
  const Eigen::Matrix3d R = T_camera_tag.rotation_matrix();
  const auto corners = shape.corners();
  Vector8d residual_px;
  Matrix8x9d by_all = Matrix8x9d::Zero();
  for (int i = 0; i < kNumCorners; ++i) {
    const Eigen::Vector3d& corner = corners[static_cast<std::size_t>(i)];
    Eigen::Matrix<double, 2, 3> by_point;
    const auto pixel = probe.camera->model.project(R * corner + T_camera_tag.translation(),
                                                   jacobian == nullptr ? nullptr : &by_point);
    if (!pixel) return false;
    residual_px.segment<2>(2 * i) = *pixel - probe.view->corners_px[static_cast<std::size_t>(i)];
    if (jacobian == nullptr) continue;
    const Eigen::Matrix<double, 2, 3> by_corner = by_point * R;
    by_all.block<2, 6>(2 * i, 0) = pixel_jacobian(by_corner, corner);
    const double sign = i % 2 == 0 ? 1.0 : -1.0;
    by_all.block<2, 1>(2 * i, 6) = by_corner * Eigen::Vector3d(corner.x(), corner.y(), 0.0);
    by_all.block<2, 1>(2 * i, 7) = by_corner * Eigen::Vector3d(0.5 * corner.x(), -0.5 * corner.y(), 0.0);
    by_all.block<2, 1>(2 * i, 8) = by_corner * Eigen::Vector3d(0.0, 0.0, sign * shape.size_m);
  }
  residual_px += probe.camera->edge_offset_px * probe.view->inward;
  *residual = probe.whitening.lazyProduct(residual_px);
  if (jacobian != nullptr) *jacobian = probe.whitening.lazyProduct(by_all);
  return true;
}

/// A view's loss, by its squares.
class ViewLoss {
 public:
  ViewLoss(const ProbeView& view, double loss_scale)
      : is_by_tails_(loss_scale == kProbeLoss && view.view->claimed_px2 > 0.0), cauchy_{loss_scale} {}

  double cost(double squares) const {
    return is_by_tails_ ? kTailPower * std::log1p(squares / kTailFreedom) - kTailOffset
                        : cauchy_.cost(squares);
  }
  double weight(double squares) const {
    return is_by_tails_ ? 2.0 * kTailPower / (kTailFreedom + squares) : cauchy_.weight(squares);
  }

 private:
  bool is_by_tails_;
  CauchyLoss cauchy_;
};

double cost_of(const ProbeView& view, const Pose& T_map_tag, const TagShape& shape, double loss_scale) {
  const double squares = probe_squares(view, T_map_tag, shape);
  return view.share * (std::isfinite(squares) ? ViewLoss(view, loss_scale).cost(squares) : kUnseenCost);
}

/// Where it is more than `most`, some number that is.
double total_cost(const std::vector<ProbeView>& views, const TagFit& fit, double loss_scale,
                  double most = HUGE_VAL) {
  double sum = 0.0, left = static_cast<double>(views.size());
  for (const ProbeView& view : views) {
    sum += cost_of(view, fit.T_map_tag, fit.shape, loss_scale);
    if (sum - kTailOffset * --left > most) return HUGE_VAL;  // no view costs less
  }
  return sum;
}

struct Normal {
  Matrix9d H = Matrix9d::Zero();
  Vector9d g = Vector9d::Zero();
};

Normal normal_equations(const std::vector<ProbeView>& views, const TagFit& fit, ShapeFreedom freedom,
                        double loss_scale) {
  Normal normal;
  for (const ProbeView& view : views) {
    Vector8d residual;
    Matrix8x9d jacobian;
    if (!probe_residual(view, fit.T_map_tag, fit.shape, &residual, &jacobian)) continue;
    if (freedom == ShapeFreedom::kNone) jacobian.col(6).setZero();
    if (freedom != ShapeFreedom::kBend) jacobian.rightCols<2>().setZero();
    const double weight = view.share * ViewLoss(view, loss_scale).weight(residual.squaredNorm());
    const Matrix8x9d weighted = weight * jacobian;
    normal.H += weighted.transpose().lazyProduct(jacobian);
    normal.g += weighted.transpose().lazyProduct(residual);
  }
  for (int i = 0; i < 9; ++i) {
    if (!(normal.H(i, i) > 0.0)) normal.H(i, i) = 1.0;  // held
  }
  return normal;
}

TagFit moved_by(const TagFit& fit, const Vector9d& step) {
  TagFit result = fit;
  result.T_map_tag = fit.T_map_tag * Pose::exp(Vector6d(step.head<6>()));
  result.shape.log_scale += step[6];
  result.shape.aspect += step[7];
  result.shape.twist += step[8];
  return result;
}

TagFit descended(const std::vector<ProbeView>& views, TagFit best, ShapeFreedom freedom, double loss_scale) {
  best.cost = total_cost(views, best, loss_scale);
  double damping = 1e-4;
  for (int step = 0; step < kMaxTagSteps && damping < 1e8; ++step) {
    const Normal normal = normal_equations(views, best, freedom, loss_scale);
    bool is_better = false;
    double decrease = 0.0;
    while (!is_better && damping < 1e8) {
      Matrix9d H = normal.H;
      H.diagonal() *= 1.0 + damping;
      const Vector9d change = -H.ldlt().solve(normal.g);
      TagFit trial = change.allFinite() ? moved_by(best, change) : best;
      trial.cost = total_cost(views, trial, loss_scale);
      is_better = trial.cost < best.cost;
      damping *= is_better ? 0.1 : 10.0;
      if (!is_better) continue;
      decrease = best.cost - trial.cost;
      best = std::move(trial);
    }
    if (decrease < 1e-6 * std::abs(best.cost)) break;
  }
  return best;
}

/// Of the poses that some of the largest views, and some from all over, propose: outliers may be large, too.
TagFit best_proposal(const std::vector<ProbeView>& views, double size_m) {
  std::vector<const ProbeView*> largest;
  for (const ProbeView& view : views) largest.push_back(&view);
  std::ranges::stable_sort(largest, std::greater<>(),
                           [](const ProbeView* probe) { return mean_edge_px(probe->view->corners_px); });
  std::vector<const ProbeView*> proposers(
      largest.begin(),
      largest.begin() + static_cast<std::ptrdiff_t>(std::min(largest.size(), kMaxProposals)));
  for (std::size_t i = 0; i < kMaxProposals && !views.empty(); ++i)
    proposers.push_back(&views[i * views.size() / kMaxProposals]);
  TagFit best;
  best.shape.size_m = size_m;
  best.cost = HUGE_VAL;
  for (const ProbeView* probe : proposers) {
    for (const Pose& T_map_tag : probe->T_map_tag_proposed) {
      TagFit trial = best;
      trial.T_map_tag = T_map_tag;
      trial.cost = total_cost(views, trial, kProbeLoss, best.cost);
      if (trial.cost < best.cost) best = std::move(trial);
    }
  }
  return best;
}
}  // namespace

Eigen::Matrix<double, 8, 3> residual_by_shape(const Observations& observations, const TagView& view,
                                              const MapState& state) {
  const auto tag = static_cast<std::size_t>(view.tag);
  ProbeView probe;
  probe.view = &view;
  probe.camera = &state.cameras[static_cast<std::size_t>(view.camera)];
  probe.T_map_rig = state.T_map_rig[static_cast<std::size_t>(view.frame)];
  probe.whitening = whitening(view, state);
  TagShape shape;
  shape.size_m = observations.sizes_m[tag];
  Vector8d residual;
  Matrix8x9d jacobian = Matrix8x9d::Zero();
  if (!probe_residual(probe, state.T_map_tag[tag], shape, &residual, &jacobian)) jacobian.setZero();
  return jacobian.rightCols<3>();
}

std::array<Eigen::Vector3d, 4> TagShape::corners() const {
  std::array<Eigen::Vector3d, 4> result = tag_corners(size_m);
  for (std::size_t i = 0; i < result.size(); ++i) {
    result[i].x() *= std::exp(log_scale) * (1.0 + 0.5 * aspect);
    result[i].y() *= std::exp(log_scale) * (1.0 - 0.5 * aspect);
    result[i].z() = (i % 2 == 0 ? 1.0 : -1.0) * twist * size_m;
  }
  return result;
}

double probe_cost(const ProbeView& view, const Pose& T_map_tag, const TagShape& shape) {
  return cost_of(view, T_map_tag, shape, kProbeLoss);
}

double usual_probe_cost() {
  return CauchyLoss{kProbeLoss}.cost(8.0);
}

double usual_cost_of(const std::vector<ProbeView>& views) {
  double shares = 0.0;
  for (const ProbeView& view : views) shares += view.share;
  return usual_probe_cost() * shares;
}

double probe_squares(const ProbeView& view, const Pose& T_map_tag, const TagShape& shape) {
  Vector8d residual;
  return probe_residual(view, T_map_tag, shape, &residual, nullptr) ? residual.squaredNorm() : HUGE_VAL;
}

double cost_of_squares(const ProbeView& view, double squares) {
  return ViewLoss(view, kProbeLoss).cost(squares);
}

TagFit fit_tag(const std::vector<ProbeView>& views, TagFit start, ShapeFreedom freedom) {
  TagFit best = descended(views, std::move(start), freedom, kProbeLoss);
  const Matrix9d covariance =
      normal_equations(views, best, freedom, kProbeLoss).H.ldlt().solve(Matrix9d::Identity());
  best.covariance = covariance.topLeftCorner<6, 6>();
  best.scale_sigma = std::sqrt(std::max(0.0, covariance(6, 6)));
  best.aspect_sigma = std::sqrt(std::max(0.0, covariance(7, 7)));
  best.twist_sigma = std::sqrt(std::max(0.0, covariance(8, 8)));
  return best;
}

TagFit fit_tag_anew(const std::vector<ProbeView>& views, double size_m) {
  const TagFit start = best_proposal(views, size_m);
  const TagFit direct = fit_tag(views, start, ShapeFreedom::kNone);
  if (direct.cost < usual_cost_of(views)) return direct;
  // Few views, some of them at an angle to the others: the pose that pleases most of them may be a trap.
  TagFit coarse = descended(views, start, ShapeFreedom::kNone, kCoarseProbeLoss);
  const TagFit indirect = fit_tag(views, std::move(coarse), ShapeFreedom::kNone);
  return indirect.cost < direct.cost ? indirect : direct;
}

ShapeError shape_error_of(const TagFit& fit) {
  const TagShape& shape = fit.shape;
  return {.size_m = shape.size_m,
          .log_scale = shape.log_scale,
          .scale_sigma = fit.scale_sigma,
          .aspect = shape.aspect,
          .aspect_sigma = fit.aspect_sigma,
          .twist = shape.twist,
          .twist_sigma = fit.twist_sigma};
}

}  // namespace apriltrack
