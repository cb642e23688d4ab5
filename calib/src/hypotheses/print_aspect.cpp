#include "hypotheses/print_aspect.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "faults/tag_fit.h"

namespace apriltrack {
namespace {

constexpr double kPixelsAreSquare =
    0.005;  // what files of the same camera are off by (docs/algorithms/calibration.md, 5a)
constexpr double kMostOfPrint = 0.03;  // beyond, a picture of another format is likelier
constexpr double kClearlyNot = 3.0;    // standard deviations

bool is_of_print(const EstimatedParameter& one) {
  const double size = std::abs(one.value);
  return size > std::max(kPixelsAreSquare, kClearlyNot * one.sigma) && size < kMostOfPrint;
}

bool are_the_same(const EstimatedParameter& a, const EstimatedParameter& b) {
  return std::abs(a.value - b.value) < std::max(kPixelsAreSquare, kClearlyNot * std::hypot(a.sigma, b.sigma));
}

}  // namespace

std::optional<double> find_print_aspect(const CameraRefinement& cameras, const std::set<int>& used) {
  std::vector<EstimatedParameter> aspects;
  for (const EstimatedParameter& one : cameras.estimates)
    if (one.parameter.kind == CameraParameter::Kind::kAspect && used.contains(one.parameter.camera))
      aspects.push_back(one);
  if (aspects.empty() || aspects.size() < used.size()) return std::nullopt;
  double sum = 0.0;
  for (const EstimatedParameter& one : aspects) {
    if (!is_of_print(one) || !are_the_same(one, aspects.front())) return std::nullopt;
    sum -= one.value;
  }
  return sum / static_cast<double>(aspects.size());
}

std::optional<double> find_print_aspect(const BetterCameras& cameras, const std::set<int>& used) {
  if (!aspects_of(cameras.refined).empty()) return find_print_aspect(cameras.refined, used);
  return cameras.open ? find_print_aspect(*cameras.open, used) : std::nullopt;
}

CameraParameters aspects_of(const CameraRefinement& refined) {
  CameraParameters aspects;
  if (!refined.is_accepted) return aspects;
  for (const EstimatedParameter& one : refined.estimates)
    if (one.parameter.kind == CameraParameter::Kind::kAspect) aspects.push_back(one.parameter);
  return aspects;
}

std::vector<ParameterView> aspect_errors(const Observations& observations,
                                         const std::vector<std::size_t>& views, const MapState& state,
                                         double print_aspect, CameraParameters refined) {
  for (CameraParameter& parameter : refined) parameter.sigma = print_aspect;
  const std::vector<ParameterView> of_lenses = camera_columns(observations, views, state, refined);
  std::vector<ParameterView> columns;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Eigen::Matrix<double, 8, 3> by_shape =
        residual_by_shape(observations, observations.views[views[i]], state);
    Eigen::Matrix<double, 8, 2> by_error;
    by_error.col(0) = print_aspect * by_shape.col(1) + of_lenses[i].by_parameter.rowwise().sum();
    by_error.col(1) = 0.5 * print_aspect * by_shape.col(0);
    columns.push_back({i, by_error});
  }
  return columns;
}

}  // namespace apriltrack
