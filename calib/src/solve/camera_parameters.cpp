#include "solve/camera_parameters.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <variant>

#include "apriltrack/base/check.h"
#include "apriltrack/calib/systematic_errors.h"
#include "apriltrack/camera/camera.h"
#include "model/view_residual.h"

namespace apriltrack {
namespace {

using Kind = CameraParameter::Kind;

// How far camera files are off that were made for the camera, but another focus, crop or print of the board.
constexpr double kFocalSigma = 0.03;
constexpr double kAspectSigma = 0.005;
constexpr double kCenterSigma_px = 10.0;
constexpr double kTangentialSigma = 0.005;
constexpr double kTranslationSigma_m = 0.01;
constexpr double kRotationSigma_rad = 0.02;
constexpr double kRounding = 1e-9;  // between two writings of one lens
constexpr int kFirstTangential = 2, kFirstAfterTangential = 4;

struct WithCoefficients {
  const std::vector<double>& values;
  Distortion operator()(const NoDistortion& lens) const { return lens; }
  template <typename Lens>
  Distortion operator()(const Lens&) const {
    return Lens(values);
  }
};

std::vector<double> coefficients_of(const CameraModel& model) {
  const auto values = std::visit([](const auto& lens) { return lens.coefficients(); }, model.distortion());
  return {values.begin(), values.end()};
}

bool is_tangential(const CameraModel& model, int index) {
  return std::holds_alternative<RadtanDistortion>(model.distortion()) && index >= kFirstTangential &&
         index < kFirstAfterTangential;
}

double distortion_sigma(const CameraModel& model, int index) {
  if (is_tangential(model, index)) return kTangentialSigma;
  return std::holds_alternative<EquidistantDistortion>(model.distortion()) ? 0.02 : 0.05;
}

bool is_of_a_lens(const Pinhole& pinhole, const std::vector<double>& coefficients) {
  const auto is_finite = [](double value) { return std::isfinite(value); };
  return pinhole.fx > 0.0 && pinhole.fy > 0.0 && is_finite(pinhole.fx) && is_finite(pinhole.fy) &&
         is_finite(pinhole.cx) && is_finite(pinhole.cy) && std::ranges::all_of(coefficients, is_finite);
}

std::optional<CameraModel> moved_lens(const CameraModel& model, const CameraParameter& parameter,
                                      double step) {
  Pinhole pinhole = model.pinhole();
  std::vector<double> coefficients = coefficients_of(model);
  switch (parameter.kind) {
    case Kind::kFocalLength:
      pinhole.fx *= 1.0 + step;
      pinhole.fy *= 1.0 + step;
      break;
    case Kind::kAspect:
      pinhole.fy *= 1.0 + step;
      break;
    case Kind::kCenter:
      (parameter.index == 0 ? pinhole.cx : pinhole.cy) += step;
      break;
    default:
      coefficients[static_cast<std::size_t>(parameter.index)] += step;
  }
  if (!is_of_a_lens(pinhole, coefficients)) return std::nullopt;
  return CameraModel(pinhole, std::visit(WithCoefficients{coefficients}, model.distortion()));
}

/// Half a sigma either way is too far for the lens formula: a step that moves pixels by about a hundredth.
double difference_step(const CameraParameter& parameter) {
  switch (parameter.kind) {
    case Kind::kEdgeOffset:
    case Kind::kCenter:
      return 1e-2;
    case Kind::kTranslation:
    case Kind::kRotation:
    case Kind::kFocalLength:
    case Kind::kAspect:
    case Kind::kDistortion:
      return 1e-5;
  }
  return 1e-5;
}

/// Of residuals by one parameter, in units of its sigma.
class Difference {
 public:
  Difference(const CameraParameter& parameter, const MapState& state) {
    const RigCamera& camera = state.cameras[static_cast<std::size_t>(parameter.camera)];
    const double step = difference_step(parameter);
    above_ = moved(camera, parameter, step);
    below_ = moved(camera, parameter, -step);
    APRILTRACK_CHECK(above_ && below_, "a small step leaves a lens a lens");
    sigmas_per_step_ = 0.5 * parameter.sigma / step;
  }

  /// Zero where the view cannot be projected.
  Vector8d of(const Observations& observations, const TagView& view, const MapState& state) const {
    const double size_m = observations.sizes_m[static_cast<std::size_t>(view.tag)];
    const Pose& T_map_rig = state.T_map_rig[static_cast<std::size_t>(view.frame)];
    const Pose& T_map_tag = state.T_map_tag[static_cast<std::size_t>(view.tag)];
    Vector8d above, below;
    if (!view_residual(*above_, size_m, view, T_map_rig, T_map_tag, &above, nullptr, nullptr) ||
        !view_residual(*below_, size_m, view, T_map_rig, T_map_tag, &below, nullptr, nullptr))
      return Vector8d::Zero();
    return (above - below) * sigmas_per_step_;
  }

 private:
  std::optional<RigCamera> above_, below_;
  double sigmas_per_step_ = 0.0;
};

}  // namespace

std::string name_of(const CameraParameter& parameter, const RigCamera& camera) {
  switch (parameter.kind) {
    case Kind::kEdgeOffset:
      return "edge offset";
    case Kind::kFocalLength:
      return "focal length";
    case Kind::kAspect:
      return "fy / fx";
    case Kind::kCenter:
      return parameter.index == 0 ? "cx" : "cy";
    case Kind::kDistortion: {
      if (is_tangential(camera.model, parameter.index))
        return fmt::format("p{}", parameter.index - kFirstTangential + 1);
      const bool is_radtan = std::holds_alternative<RadtanDistortion>(camera.model.distortion());
      return fmt::format(
          "k{}", parameter.index + 1 - (is_radtan && parameter.index >= kFirstAfterTangential ? 2 : 0));
    }
    case Kind::kTranslation:
      return fmt::format("translation {}", "xyz"[parameter.index]);
    case Kind::kRotation:
      return fmt::format("rotation {}", "xyz"[parameter.index]);
  }
  return "";
}

std::string unit_of(const CameraParameter& parameter) {
  switch (parameter.kind) {
    case Kind::kEdgeOffset:
    case Kind::kCenter:
      return "px";
    case Kind::kTranslation:
      return "m";
    case Kind::kRotation:
      return "rad";
    default:
      return "1";
  }
}

CameraParameters edge_offset_parameters(const std::vector<int>& cameras, double sigma_px) {
  CameraParameters parameters;
  for (const int camera : cameras) parameters.push_back({camera, Kind::kEdgeOffset, 0, sigma_px});
  return parameters;
}

CameraParameters intrinsic_parameters(const std::vector<int>& cameras, const std::vector<RigCamera>& rig) {
  CameraParameters parameters;
  for (const int camera : cameras) {
    const CameraModel& model = rig[static_cast<std::size_t>(camera)].model;
    parameters.push_back({camera, Kind::kFocalLength, 0, kFocalSigma});
    parameters.push_back({camera, Kind::kAspect, 0, kAspectSigma});
    parameters.push_back({camera, Kind::kCenter, 0, kCenterSigma_px});
    parameters.push_back({camera, Kind::kCenter, 1, kCenterSigma_px});
    for (int i = 0; i < static_cast<int>(coefficients_of(model).size()); ++i)
      parameters.push_back({camera, Kind::kDistortion, i, distortion_sigma(model, i)});
  }
  return parameters;
}

CameraParameters extrinsic_parameters(const std::vector<int>& cameras) {
  CameraParameters parameters;
  for (std::size_t i = 1; i < cameras.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      parameters.push_back({cameras[i], Kind::kTranslation, axis, kTranslationSigma_m});
      parameters.push_back({cameras[i], Kind::kRotation, axis, kRotationSigma_rad});
    }
  }
  return parameters;
}

std::optional<CameraParameter> parameter_of(const CameraCorrection& correction,
                                            const std::vector<RigCamera>& rig) {
  std::vector<int> cameras(rig.size());
  std::iota(cameras.begin(), cameras.end(), 0);
  for (const auto& group : {edge_offset_parameters(cameras, 1.0), intrinsic_parameters(cameras, rig),
                            extrinsic_parameters(cameras)}) {
    for (const CameraParameter& one : group) {
      const RigCamera& camera = rig[static_cast<std::size_t>(one.camera)];
      if (camera.name == correction.camera && name_of(one, camera) == correction.parameter) return one;
    }
  }
  return std::nullopt;
}

std::optional<RigCamera> moved(const RigCamera& camera, const CameraParameter& parameter, double step) {
  RigCamera result = camera;
  if (parameter.kind == Kind::kEdgeOffset) {
    result.edge_offset_px += step;
  } else if (parameter.is_of_place()) {
    Vector6d xi = Vector6d::Zero();
    xi[parameter.index + (parameter.kind == Kind::kRotation ? 3 : 0)] = step;
    result.T_camera_rig = camera.T_camera_rig * Pose::exp(xi);
  } else {
    const std::optional<CameraModel> lens = moved_lens(camera.model, parameter, step);
    if (!lens) return std::nullopt;
    result.model = *lens;
  }
  return result;
}

double difference(const RigCamera& from, const RigCamera& to, const CameraParameter& parameter) {
  const Pinhole &lens = from.model.pinhole(), &other_lens = to.model.pinhole();
  const auto i = static_cast<std::size_t>(parameter.index);
  switch (parameter.kind) {
    case Kind::kEdgeOffset:
      return to.edge_offset_px - from.edge_offset_px;
    case Kind::kFocalLength:
      return other_lens.fx / lens.fx - 1.0;
    case Kind::kAspect:
      return other_lens.fy / other_lens.fx * lens.fx / lens.fy - 1.0;
    case Kind::kCenter:
      return parameter.index == 0 ? other_lens.cx - lens.cx : other_lens.cy - lens.cy;
    case Kind::kDistortion:
      return coefficients_of(to.model)[i] - coefficients_of(from.model)[i];
    case Kind::kTranslation:
    case Kind::kRotation:
      return (from.T_camera_rig.inverse() * to.T_camera_rig)
          .log()[parameter.index + (parameter.kind == Kind::kRotation ? 3 : 0)];
  }
  return 0.0;
}

bool has_other_lens(const RigCamera& camera, const RigCamera& than) {
  return std::ranges::any_of(intrinsic_parameters({0}, {than}), [&](const CameraParameter& one) {
    return std::abs(difference(than, camera, one)) > kRounding;
  });
}

bool have_other_lenses(const std::vector<RigCamera>& cameras, const std::vector<RigCamera>& than) {
  return !std::ranges::equal(cameras, than,
                             [](const RigCamera& a, const RigCamera& b) { return !has_other_lens(a, b); });
}

CameraRig with_corrections(const CameraRig& rig, const std::vector<RigCamera>& cameras,
                           const CameraParameters& parameters) {
  CameraRig result = rig;
  std::set<std::size_t> moved_places;
  for (const CameraParameter& one : parameters) {
    if (one.is_of_place()) moved_places.insert(static_cast<std::size_t>(one.camera));
  }
  const auto place = [&](std::size_t i) {
    return moved_places.contains(i) ? cameras[i].T_camera_rig : rig.T_camera_rig(i);
  };
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    result.cameras[i].model = cameras[i].model;
    if (rig.cameras[i].T_this_previous && (moved_places.contains(i) || moved_places.contains(i - 1)))
      result.cameras[i].T_this_previous = place(i) * place(i - 1).inverse();
  }
  return result;
}

std::vector<ParameterView> camera_columns(const Observations& observations,
                                          const std::vector<std::size_t>& views, const MapState& state,
                                          const CameraParameters& parameters) {
  std::vector<Difference> differences;
  for (const CameraParameter& parameter : parameters) differences.emplace_back(parameter, state);
  std::vector<ParameterView> columns;
  columns.reserve(views.size());
  for (const std::size_t v : views) {
    const TagView& view = observations.views[v];
    Eigen::Matrix<double, 8, Eigen::Dynamic> by_parameter =
        Eigen::MatrixXd::Zero(8, static_cast<Eigen::Index>(parameters.size()));
    for (std::size_t p = 0; p < parameters.size(); ++p) {
      if (view.camera == parameters[p].camera)
        by_parameter.col(static_cast<Eigen::Index>(p)) = differences[p].of(observations, view, state);
    }
    columns.push_back({columns.size(), whitening(view, state) * by_parameter});
  }
  return columns;
}

std::vector<ParameterView> with_independent_errors(std::vector<ParameterView> columns,
                                                   const Eigen::MatrixXd& covariance) {
  // Scaled, since shares of a focal length and pixels differ by many powers of ten.
  const Eigen::VectorXd sigmas = covariance.diagonal().cwiseMax(1e-300).cwiseSqrt();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      (covariance.array() / (sigmas * sigmas.transpose()).array()).matrix());
  const Eigen::MatrixXd root = sigmas.asDiagonal() * solver.eigenvectors() *
                               solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  for (ParameterView& column : columns) column.by_parameter *= root;
  return columns;
}

CameraParameters operator+(CameraParameters some, const CameraParameters& more) {
  some.insert(some.end(), more.begin(), more.end());
  return some;
}

}  // namespace apriltrack
