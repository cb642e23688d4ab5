#include "initialise/lens_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "numerics/cauchy_loss.h"
#include "numerics/upper_median.h"

namespace apriltrack {
namespace {

constexpr double kLessKnown = 10.0;  // than numbers of a file that is about right
constexpr int kMostShortenings = 5, kStepsOfPose = 3;
constexpr CauchyLoss kLossOfRemains{4.0};  // of their noise
constexpr double kOutOfSight = 10.0;       // what a view costs, in these, that the lens does not reach
constexpr int kNumRemains = 2;             // of a view's eight numbers, once six are spent on its pose

/// Each view in a frame of its own, the one camera before a tag that hangs at the origin.
Observations single_views(const Observations& observations, const RigCamera& camera,
                          const std::vector<std::size_t>& views) {
  Observations single{observations.tags,
                      std::vector<double>(observations.tags.size(), 1.0),  // any size will do
                      std::vector<Timestamp>(views.size()),
                      {camera},
                      {}};
  single.cameras.front().T_camera_rig = Pose::identity();
  for (const std::size_t v : views) {
    single.views.push_back(observations.views[v]);
    single.views.back().camera = 0;
    single.views.back().frame = static_cast<int>(single.views.size()) - 1;
  }
  return single;
}

/// fy / fx is little known only where the file has no square pixels: prints that were stretched would change
/// it.
CameraParameters little_known_lens(const Observations& observations) {
  const Pinhole& pinhole = observations.cameras.front().model.pinhole();
  CameraParameters parameters = intrinsic_parameters({0}, observations.cameras);
  for (CameraParameter& one : parameters) {
    if (one.kind == CameraParameter::Kind::kAspect)
      one.sigma = std::max(one.sigma, std::abs(std::log(pinhole.fy / pinhole.fx)));
    else
      one.sigma *= kLessKnown;
  }
  return parameters;
}

}  // namespace

LensFit::LensFit(const Observations& observations, const RigCamera& file,
                 const std::vector<std::size_t>& views, const ParallelFor& parallel)
    : single_(single_views(observations, file, views)),
      file_(single_.cameras.front()),
      parameters_(little_known_lens(single_)),
      parallel_(parallel),
      views_(views.size()) {
  std::iota(views_.begin(), views_.end(), std::size_t{0});
}

Lens LensFit::lens_of(const RigCamera& start) {
  Lens lens{start, Eigen::VectorXd(static_cast<Eigen::Index>(parameters_.size())), state_by(start)};
  for (std::size_t p = 0; p < parameters_.size(); ++p)
    lens.total[static_cast<Eigen::Index>(p)] =
        difference(file_, start, parameters_[p]) / parameters_[p].sigma;
  return lens;
}

double LensFit::noise(const Lens& lens) const {
  std::vector<double> squares;
  for (const std::size_t v : views_) squares.push_back(squares_of(lens.state, v));
  const double median = upper_median(std::move(squares));
  return std::sqrt(std::max(1.0, median / (2.0 * std::log(2.0))));  // of chi squared with two degrees
}

double LensFit::cost(const Lens& lens, double noise) const {
  double sum = 0.5 * lens.total.squaredNorm();
  for (const std::size_t v : views_) sum += kLossOfRemains.cost(squares_of(lens.state, v) / (noise * noise));
  return sum;
}

LensFit::Step LensFit::step(const Lens& lens, double noise) const {
  const Eigen::Index num = lens.total.size();
  Eigen::MatrixXd information = Eigen::MatrixXd::Identity(num, num);
  Eigen::VectorXd gradient = lens.total;
  for (const Remains& one : remains(lens.state)) {
    const double noise2 = noise * noise;
    const double weight = kLossOfRemains.weight(one.residual.squaredNorm() / noise2) / noise2;
    information += weight * one.by_parameter.transpose() * one.by_parameter;
    gradient += weight * one.by_parameter.transpose() * one.residual;
  }
  const Eigen::VectorXd result = -information.ldlt().solve(gradient);
  return {result / std::max(1.0, result.cwiseAbs().maxCoeff()), -0.5 * gradient.dot(result)};
}

bool LensFit::move(Eigen::VectorXd step, double noise, Lens& lens) {
  const double before = cost(lens, noise);
  for (int i = 0; i < kMostShortenings; ++i, step *= 0.5) {
    auto next = moved_by(lens, step);
    if (!next || !(cost(*next, noise) < before)) continue;
    lens = std::move(*next);
    return true;
  }
  return false;
}

std::optional<Lens> LensFit::moved_by(const Lens& lens, const Eigen::VectorXd& step) {
  Lens next{lens.camera, lens.total + step, {}};
  for (std::size_t p = 0; p < parameters_.size(); ++p) {
    const auto camera =
        moved(next.camera, parameters_[p], step[static_cast<Eigen::Index>(p)] * parameters_[p].sigma);
    if (!camera) return std::nullopt;
    next.camera = *camera;
  }
  next.state = state_by(next.camera);
  return next;
}

/// Each tag in the likelier of its two poses, and from there where its corners fit best.
MapState LensFit::state_by(const RigCamera& camera) {
  single_.cameras = {camera};
  const std::vector<ViewCandidates> candidates = solve_views(single_, views_, parallel_);
  MapState state{
      std::vector<Pose>(single_.tags.size()), std::vector<Pose>(views_.size()), single_.cameras, {}};
  parallel_(views_.size(), [&](std::size_t v) {
    if (candidates[v].candidates.empty()) return;
    state.T_map_rig[v] = candidates[v].candidates.front().T_rig_tag.inverse();
    for (int i = 0; i < kStepsOfPose; ++i) {
      Vector8d residual;
      Matrix8x6d by_pose;
      if (!residual_of(single_, single_.views[v], state, &residual, &by_pose)) return;
      const Matrix8d& whitening = single_.views[v].whitening;
      const Vector6d step = (whitening * by_pose).colPivHouseholderQr().solve(-whitening * residual);
      if (!step.allFinite()) return;
      state.T_map_rig[v] = state.T_map_rig[v] * Pose::exp(step);
    }
  });
  return state;
}

double LensFit::squares_of(const MapState& state, std::size_t view) const {
  Vector8d residual;
  if (!residual_of(single_, single_.views[view], state, &residual)) return kOutOfSight * kOutOfSight;
  return (single_.views[view].whitening * residual).squaredNorm();
}

std::vector<LensFit::Remains> LensFit::remains(const MapState& state) const {
  std::vector<ParameterView> columns = camera_columns(single_, views_, state, parameters_);
  std::vector<Remains> result(views_.size());
  parallel_(views_.size(), [&](std::size_t v) {
    result[v] = {Vector8d::Zero(), Eigen::MatrixXd::Zero(8, columns[v].by_parameter.cols())};
    Matrix8x6d by_pose;
    Vector8d residual;
    if (!residual_of(single_, single_.views[v], state, &residual, &by_pose)) return;
    const Matrix8d& whitening = single_.views[v].whitening;
    const Eigen::HouseholderQR<Matrix8x6d> of_pose(whitening * by_pose);
    const Matrix8d all = of_pose.householderQ();
    const Matrix8d rest = all.rightCols<kNumRemains>() * all.rightCols<kNumRemains>().transpose();
    result[v] = {rest * whitening * residual, rest * columns[v].by_parameter};
  });
  return result;
}

}  // namespace apriltrack
