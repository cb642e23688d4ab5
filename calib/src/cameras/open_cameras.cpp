#include "cameras/open_cameras.h"

#include <algorithm>
#include <cmath>

namespace apriltrack {
namespace {

// Standard deviations. Fewer make maps by right cameras too unsure, more leave wrong ones unsaid
// (bench/reports/2026-11-27/calibration_open_cameras.md).
constexpr double kAsExpected = 1.0, kClearlyOff = 3.0;

bool is_of_edges(const CameraParameter& parameter) {
  return parameter.kind == CameraParameter::Kind::kEdgeOffset;
}

using IsMeant = bool (*)(const CameraParameter&);

bool is_any_off(const CameraRefinement& cameras, double sigmas, IsMeant is_meant) {
  return std::ranges::any_of(cameras.estimates, [&](const EstimatedParameter& one) {
    return is_meant(one.parameter) && std::abs(one.value) > sigmas * one.sigma;
  });
}

/// Where one that is meant is off by more than `sigmas`.
std::optional<CameraRefinement> open_where_off(const PartTask& task, const CameraParameters& parameters,
                                               double sigmas, IsMeant is_meant, const AdjustedPart& solved) {
  auto open = open_parameters(task, parameters, solved);
  return open && is_any_off(*open, sigmas, is_meant) ? open : std::nullopt;
}

}  // namespace

std::optional<CameraRefinement> find_open_cameras(const PartTask& task, const CameraRefinement& refined,
                                                  const AdjustedPart& solved) {
  const CameraParameters known = parameters_of(refined);
  const std::vector<int> cameras = cameras_of(task.observations, solved.part);
  CameraParameters edges, lenses, places;
  if (task.options.edge_offset_sigma_px > 0.0 && std::ranges::none_of(known, is_of_edges))
    edges = edge_offset_parameters(cameras, task.options.edge_offset_sigma_px);
  if (std::ranges::none_of(known, &CameraParameter::is_of_lens))
    lenses = intrinsic_parameters(cameras, task.observations.cameras);
  if (std::ranges::none_of(known, &CameraParameter::is_of_place)) places = extrinsic_parameters(cameras);
  const IsMeant is_of_lens = [](const CameraParameter& one) { return one.is_of_lens(); };
  const IsMeant is_of_place = [](const CameraParameter& one) { return one.is_of_place(); };
  const IsMeant is_in_file = [](const CameraParameter& one) { return one.is_of_lens() || one.is_of_place(); };
  std::optional<CameraRefinement> open;
  if (!places.empty()) {
    open = open_where_off(task, known + edges + lenses + places, kClearlyOff, is_in_file, solved);
    if (!open) open = open_where_off(task, known + edges + places, kAsExpected, is_of_place, solved);
  }
  if (!open && !lenses.empty())
    open = open_where_off(task, known + edges + lenses, kClearlyOff, is_of_lens, solved);
  return open ? open : open_where_off(task, edges, kAsExpected, is_of_edges, solved);
}

}  // namespace apriltrack
