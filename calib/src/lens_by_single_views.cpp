#include "lens_by_single_views.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "apriltrack/base/error.h"
#include "camera_parameters.h"
#include "cauchy_loss.h"
#include "map_state.h"

namespace apriltrack {
namespace {

constexpr std::size_t kMostViewsForLens = 2000;
constexpr double kLessKnown = 10.0;  // than numbers of a file that is about right
constexpr int kMostLensSteps = 30, kMostShortenings = 5, kStepsOfPose = 3;
constexpr double kStill = 0.01;         // of what a number is known by
constexpr double kLossOfRemains = 4.0;  // of their noise
constexpr double kOutOfSight = 10.0;    // what a view costs, in these, that the lens does not reach
constexpr int kNumRemains = 2;          // of a view's eight numbers, once six are spent on its pose
constexpr double kClearly = 10.0;       // chi squared that a number of the lens explains; chance makes it one
constexpr double kMuchLess = 0.3;       // of all disagreement

std::vector<std::size_t> some_of(const std::vector<std::size_t>& views) {
  std::vector<std::size_t> some;
  const std::size_t num = std::min(views.size(), kMostViewsForLens);
  for (std::size_t i = 0; i < num; ++i) some.push_back(views[i * views.size() / num]);
  return some;
}

/// Each view in a frame of its own, its camera before a tag that hangs at the origin.
Observations single_views(const Observations& observations, const std::vector<std::size_t>& views) {
  Observations single = observations;
  for (RigCamera& camera : single.cameras) camera.T_camera_rig = Pose::identity();
  single.frames.assign(views.size(), Timestamp{});
  single.views.clear();
  for (const std::size_t v : views) {
    single.views.push_back(observations.views[v]);
    single.views.back().frame = static_cast<int>(single.views.size()) - 1;
  }
  return single;
}

std::vector<CameraParameter> little_known_lenses(const Observations& observations) {
  std::set<int> cameras;
  for (const TagView& view : observations.views) cameras.insert(view.camera);
  std::vector<CameraParameter> parameters =
      intrinsic_parameters({cameras.begin(), cameras.end()}, observations.cameras);
  for (CameraParameter& one : parameters) one.sigma *= kLessKnown;
  return parameters;
}

/// What a view leaves of its residual and of the derivatives, whatever its pose.
struct Remains {
  Vector8d residual;
  Eigen::MatrixXd by_parameter;
};

/// Lenses, and how well the views agree with them.
struct Lenses {
  std::vector<RigCamera> cameras;
  Eigen::VectorXd total;  ///< How far from the file's, in sigmas of the parameters.
  MapState state;
};

/// Least squares over lenses, robust, each view's pose following.
class LensFit {
 public:
  LensFit(Observations single, const ParallelFor& parallel)
      : single_(std::move(single)), parameters_(little_known_lenses(single_)), parallel_(parallel) {
    for (std::size_t v = 0; v < single_.views.size(); ++v) views_.push_back(v);
  }

  Lenses of_file() {
    const auto num = static_cast<Eigen::Index>(parameters_.size());
    return {single_.cameras, Eigen::VectorXd::Zero(num), state_by(single_.cameras)};
  }

  /// In units of the noise that is expected, or found, where that is more.
  double noise(const Lenses& lenses) const {
    std::vector<double> squares;
    for (const std::size_t v : views_) squares.push_back(squares_of(lenses.state, v));
    const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
    std::ranges::nth_element(squares, middle);
    return std::sqrt(std::max(1.0, *middle / (2.0 * std::log(2.0))));  // of chi squared with two degrees
  }

  double cost(const Lenses& lenses, double noise) const {
    double sum = 0.5 * lenses.total.squaredNorm();
    for (const std::size_t v : views_)
      sum += CauchyLoss{kLossOfRemains}.cost(squares_of(lenses.state, v) / (noise * noise));
    return sum;
  }

  /// In sigmas of the parameters, of which it is one at most. gain: by how much the cost would fall by
  /// all of it, to first order.
  Eigen::VectorXd step(const Lenses& lenses, double noise, double& gain) const {
    const Eigen::Index num = lenses.total.size();
    Eigen::MatrixXd information = Eigen::MatrixXd::Identity(num, num);
    Eigen::VectorXd gradient = lenses.total;
    for (const Remains& one : remains(lenses.state)) {
      const double noise2 = noise * noise;
      const double weight = CauchyLoss{kLossOfRemains}.weight(one.residual.squaredNorm() / noise2) / noise2;
      information += weight * one.by_parameter.transpose() * one.by_parameter;
      gradient += weight * one.by_parameter.transpose() * one.residual;
    }
    const Eigen::VectorXd result = -information.ldlt().solve(gradient);
    gain = -0.5 * gradient.dot(result);
    return result / std::max(1.0, result.cwiseAbs().maxCoeff());
  }

  /// False, and `lenses` as they were, where no part of the step makes the views agree better.
  bool move(Eigen::VectorXd step, double noise, Lenses& lenses) {
    const double before = cost(lenses, noise);
    for (int i = 0; i < kMostShortenings; ++i, step *= 0.5) {
      auto next = moved_by(lenses, step);
      if (!next || !(cost(*next, noise) < before)) continue;
      lenses = std::move(*next);
      return true;
    }
    return false;
  }

 private:
  std::optional<Lenses> moved_by(const Lenses& lenses, const Eigen::VectorXd& step) {
    Lenses next{lenses.cameras, lenses.total + step, {}};
    try {
      for (std::size_t p = 0; p < parameters_.size(); ++p) {
        RigCamera& camera = next.cameras[static_cast<std::size_t>(parameters_[p].camera)];
        camera = moved(camera, parameters_[p], step[static_cast<Eigen::Index>(p)] * parameters_[p].sigma);
      }
    } catch (const Error&) {  // a lens that no formula describes
      return std::nullopt;
    }
    next.state = state_by(next.cameras);
    return next;
  }

  /// Each tag in the likelier of its two poses, and from there where its corners fit best.
  MapState state_by(const std::vector<RigCamera>& cameras) {
    single_.cameras = cameras;
    const std::vector<ViewCandidates> candidates = solve_views(single_, views_, parallel_);
    MapState state{std::vector<Pose>(single_.tags.size()), std::vector<Pose>(views_.size()), cameras, {}};
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

  double squares_of(const MapState& state, std::size_t v) const {
    Vector8d residual;
    if (!residual_of(single_, single_.views[v], state, &residual)) return kOutOfSight * kOutOfSight;
    return (single_.views[v].whitening * residual).squaredNorm();
  }

  std::vector<Remains> remains(const MapState& state) const {
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

  Observations single_;
  std::vector<CameraParameter> parameters_;
  const ParallelFor& parallel_;
  std::vector<std::size_t> views_;
};

/// Other than by chance, and than what edges beside the true ones, or a few bent tags, make of a right lens.
bool is_clearly_less(double before, double gain, Eigen::Index num_parameters) {
  return 2.0 * gain > kClearly * static_cast<double>(num_parameters) && gain > kMuchLess * before;
}

}  // namespace

std::optional<std::vector<RigCamera>> lens_by_single_views(const Observations& observations,
                                                           const std::vector<std::size_t>& views,
                                                           const ParallelFor& parallel) {
  if (views.empty()) return std::nullopt;
  LensFit fit(single_views(observations, some_of(views)), parallel);
  const Lenses of_file = fit.of_file();
  Lenses lenses = of_file;
  for (int i = 0; i < kMostLensSteps; ++i) {
    const double noise = fit.noise(lenses);
    double gain = 0.0;
    const Eigen::VectorXd step = fit.step(lenses, noise, gain);
    if (i == 0 && !is_clearly_less(fit.cost(lenses, noise), gain, step.size())) return std::nullopt;
    if (!fit.move(step, noise, lenses) || step.cwiseAbs().maxCoeff() < kStill) break;
  }
  const double noise = fit.noise(lenses), before = fit.cost(of_file, noise);
  if (!is_clearly_less(before, before - fit.cost(lenses, noise), lenses.total.size())) return std::nullopt;
  std::vector<RigCamera> cameras = observations.cameras;
  for (std::size_t c = 0; c < cameras.size(); ++c) cameras[c].model = lenses.cameras[c].model;
  return cameras;
}

}  // namespace apriltrack
