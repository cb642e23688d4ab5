#include "lens_by_single_views.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "apriltrack/base/error.h"
#include "camera_parameters.h"
#include "cauchy_loss.h"
#include "map_state.h"

namespace apriltrack {
namespace {

constexpr std::size_t kMostViewsForLens = 2000;
constexpr double kPlace_px = 24.0;   // a tag that is seen there again says the same once more
constexpr double kLessKnown = 10.0;  // than numbers of a file that is about right
constexpr int kMostLensSteps = 30, kMostShortenings = 5, kStepsOfPose = 3;
constexpr double kStill = 0.01;             // of what a number is known by
constexpr double kLossOfRemains = 4.0;      // of their noise
constexpr double kOutOfSight = 10.0;        // what a view costs, in these, that the lens does not reach
constexpr int kNumRemains = 2;              // of a view's eight numbers, once six are spent on its pose
constexpr std::size_t kViewsPerNumber = 5;  // of a lens, at least
constexpr double kClearly = 10.0;     // chi squared that a number of the lens explains; chance makes it one
constexpr double kOtherSize = 0.2;    // logarithm of a picture's scale
constexpr double kWorthALook = 0.08;  // of all disagreement, by one step; noise that is to fall hides more
constexpr double kMuchLess = 0.3;     // of all disagreement

/// One view of each tag at each place in the camera's picture: neighbouring frames repeat their errors. Of
/// too many such, some from all over the picture.
std::vector<std::size_t> views_apart(const Observations& observations, int camera) {
  std::map<std::tuple<int, int, int>, std::size_t> first;  // by place, then tag
  for (std::size_t v = 0; v < observations.views.size(); ++v) {
    const TagView& view = observations.views[v];
    if (view.camera != camera) continue;
    const Eigen::Vector2d place =
        (view.corners_px[0] + view.corners_px[1] + view.corners_px[2] + view.corners_px[3]) /
        (4.0 * kPlace_px);
    first.try_emplace(
        {static_cast<int>(std::floor(place.y())), static_cast<int>(std::floor(place.x())), view.tag}, v);
  }
  std::vector<std::size_t> all, some;
  for (const auto& [place, v] : first) all.push_back(v);
  const std::size_t num = std::min(all.size(), kMostViewsForLens);
  for (std::size_t i = 0; i < num; ++i) some.push_back(all[i * all.size() / num]);
  return some;
}

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
std::vector<CameraParameter> little_known_lens(const Observations& observations) {
  const Pinhole& pinhole = observations.cameras.front().model.pinhole();
  std::vector<CameraParameter> parameters = intrinsic_parameters({0}, observations.cameras);
  for (CameraParameter& one : parameters) {
    if (one.kind == CameraParameter::Kind::kAspect)
      one.sigma = std::max(one.sigma, std::abs(std::log(pinhole.fy / pinhole.fx)));
    else
      one.sigma *= kLessKnown;
  }
  return parameters;
}

/// What a view leaves of its residual and of the derivatives, whatever its pose.
struct Remains {
  Vector8d residual;
  Eigen::MatrixXd by_parameter;
};

/// A lens, and the views' poses by it.
struct Lens {
  RigCamera camera;
  Eigen::VectorXd total;  ///< How far from the file's, in sigmas of the parameters.
  MapState state;
};

/// Least squares over a lens, robust, each view's pose following.
class LensFit {
 public:
  LensFit(Observations single, const ParallelFor& parallel)
      : single_(std::move(single)),
        file_(single_.cameras.front()),
        parameters_(little_known_lens(single_)),
        parallel_(parallel) {
    for (std::size_t v = 0; v < single_.views.size(); ++v) views_.push_back(v);
  }

  /// start: as far from the file's as it is.
  Lens lens_of(const RigCamera& start) {
    Lens lens{start, Eigen::VectorXd(static_cast<Eigen::Index>(parameters_.size())), state_by(start)};
    for (std::size_t p = 0; p < parameters_.size(); ++p)
      lens.total[static_cast<Eigen::Index>(p)] =
          difference(file_, start, parameters_[p]) / parameters_[p].sigma;
    return lens;
  }
  const RigCamera& file() const { return file_; }

  /// In units of the noise that is expected, or found, where that is more.
  double noise(const Lens& lens) const {
    std::vector<double> squares;
    for (const std::size_t v : views_) squares.push_back(squares_of(lens.state, v));
    const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
    std::ranges::nth_element(squares, middle);
    return std::sqrt(std::max(1.0, *middle / (2.0 * std::log(2.0))));  // of chi squared with two degrees
  }

  double cost(const Lens& lens, double noise) const {
    double sum = 0.5 * lens.total.squaredNorm();
    for (const std::size_t v : views_)
      sum += CauchyLoss{kLossOfRemains}.cost(squares_of(lens.state, v) / (noise * noise));
    return sum;
  }

  struct Step {
    Eigen::VectorXd by;  ///< In sigmas of the parameters, one of them at most.
    double gain = 0.0;   ///< By how much the cost would fall by all of it, to first order.
  };
  Step step(const Lens& lens, double noise) const {
    const Eigen::Index num = lens.total.size();
    Eigen::MatrixXd information = Eigen::MatrixXd::Identity(num, num);
    Eigen::VectorXd gradient = lens.total;
    for (const Remains& one : remains(lens.state)) {
      const double noise2 = noise * noise;
      const double weight = CauchyLoss{kLossOfRemains}.weight(one.residual.squaredNorm() / noise2) / noise2;
      information += weight * one.by_parameter.transpose() * one.by_parameter;
      gradient += weight * one.by_parameter.transpose() * one.residual;
    }
    const Eigen::VectorXd result = -information.ldlt().solve(gradient);
    return {result / std::max(1.0, result.cwiseAbs().maxCoeff()), -0.5 * gradient.dot(result)};
  }

  /// False, and `lens` as they were, where no part of the step makes the views agree better.
  bool move(Eigen::VectorXd step, double noise, Lens& lens) {
    const double before = cost(lens, noise);
    for (int i = 0; i < kMostShortenings; ++i, step *= 0.5) {
      auto next = moved_by(lens, step);
      if (!next || !(cost(*next, noise) < before)) continue;
      lens = std::move(*next);
      return true;
    }
    return false;
  }

 private:
  std::optional<Lens> moved_by(const Lens& lens, const Eigen::VectorXd& step) {
    Lens next{lens.camera, lens.total + step, {}};
    try {
      for (std::size_t p = 0; p < parameters_.size(); ++p)
        next.camera =
            moved(next.camera, parameters_[p], step[static_cast<Eigen::Index>(p)] * parameters_[p].sigma);
    } catch (const Error&) {  // a lens that no formula describes
      return std::nullopt;
    }
    next.state = state_by(next.camera);
    return next;
  }

  /// Each tag in the likelier of its two poses, and from there where its corners fit best.
  MapState state_by(const RigCamera& camera) {
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
  RigCamera file_;
  std::vector<CameraParameter> parameters_;
  const ParallelFor& parallel_;
  std::vector<std::size_t> views_;
};

/// Other than by chance, and than what edges beside the true ones, or a few bent tags, make of a right lens.
bool is_clearly_less(double before, double gain, Eigen::Index num_parameters, double share = kMuchLess) {
  return 2.0 * gain > kClearly * static_cast<double>(num_parameters) && gain > share * before;
}

/// The file's own centre is that of the picture, about; what is seen lies about the centre, too.
double scale_of_pictures(const Observations& observations, const Pinhole& pinhole,
                         const std::vector<std::size_t>& views) {
  Eigen::AlignedBox2d seen;
  for (const std::size_t v : views)
    for (const Eigen::Vector2d& corner : observations.views[v].corners_px) seen.extend(corner);
  const double scale = 0.5 * (seen.center().x() / pinhole.cx + seen.center().y() / pinhole.cy);
  return scale > 0.1 && scale < 10.0 ? scale : 1.0;
}

RigCamera scaled(RigCamera camera, double scale) {
  const Pinhole& p = camera.model.pinhole();
  camera.model = {{scale * p.fx, scale * p.fy, scale * p.cx, scale * p.cy}, camera.model.distortion()};
  return camera;
}

Lens descended(LensFit& fit, Lens lens) {
  for (int i = 0; i < kMostLensSteps; ++i) {
    const double noise = fit.noise(lens);
    const Eigen::VectorXd step = fit.step(lens, noise).by;
    if (!fit.move(step, noise, lens) || step.cwiseAbs().maxCoeff() < kStill) break;
  }
  return lens;
}

bool is_equidistant(const CameraModel& model) {
  return std::holds_alternative<EquidistantDistortion>(model.distortion());
}

CameraModel undistorted(const Pinhole& pinhole, bool is_to_be_equidistant) {
  if (is_to_be_equidistant) return {pinhole, EquidistantDistortion({0.0, 0.0, 0.0, 0.0})};
  return {pinhole, RadtanDistortion({0.0, 0.0, 0.0, 0.0})};
}

/// A lens that views agree with, and how well: in units of `noise`.
struct Candidate {
  CameraModel model;
  double cost = 0.0;
};

/// The best from the file's numbers, as they are and as those of pictures of another size.
Candidate best_of_model(const Observations& observations, RigCamera camera, const CameraModel& model,
                        const std::vector<std::size_t>& views, double noise, const ParallelFor& parallel) {
  camera.model = model;
  LensFit fit(single_views(observations, camera, views), parallel);
  Lens best = descended(fit, fit.lens_of(fit.file()));
  const double scale = scale_of_pictures(observations, model.pinhole(), views);
  if (std::abs(std::log(scale)) > kOtherSize) {
    Lens other = descended(fit, fit.lens_of(scaled(fit.file(), scale)));
    if (fit.cost(other, noise) < fit.cost(best, noise)) best = std::move(other);
  }
  return {best.camera.model, fit.cost(best, noise)};
}

}  // namespace

CameraModel with_distortion(const CameraModel& model) {
  return std::holds_alternative<NoDistortion>(model.distortion()) ? undistorted(model.pinhole(), false)
                                                                  : model;
}

CameraModel without_numbers(const CameraModel& like, const Pinhole& pinhole) {
  return undistorted(pinhole, is_equidistant(like));
}

std::optional<CameraModel> lens_by_single_views(const Observations& observations, int camera,
                                                const ParallelFor& parallel) {
  const std::vector<std::size_t> views = views_apart(observations, camera);
  RigCamera of_file = observations.cameras[static_cast<std::size_t>(camera)];
  of_file.model = with_distortion(of_file.model);
  LensFit fit(single_views(observations, of_file, views), parallel);
  const Lens lens = fit.lens_of(of_file);
  const Eigen::Index num = lens.total.size();
  if (views.size() < kViewsPerNumber * static_cast<std::size_t>(num)) return std::nullopt;
  const double noise = fit.noise(lens);
  if (!is_clearly_less(fit.cost(lens, noise), fit.step(lens, noise).gain, num, kWorthALook))
    return std::nullopt;

  const double noise_after = fit.noise(descended(fit, lens)), before = fit.cost(lens, noise_after);
  const Candidate same = best_of_model(observations, of_file, of_file.model, views, noise_after, parallel);
  const CameraModel other_model = undistorted(of_file.model.pinhole(), !is_equidistant(of_file.model));
  const Candidate other = best_of_model(observations, of_file, other_model, views, noise_after, parallel);
  const bool is_other_model = is_clearly_less(same.cost, same.cost - other.cost, num);
  const Candidate& best = is_other_model ? other : same;
  if (!is_clearly_less(before, before - best.cost, num)) return std::nullopt;
  return best.model;
}

}  // namespace apriltrack
