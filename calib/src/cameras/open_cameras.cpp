#include "cameras/open_cameras.h"

#include <algorithm>
#include <cmath>
#include <optional>

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

}  // namespace

std::optional<CameraRefinement> find_open_cameras(const PartTask& task, const CameraRefinement& refined,
                                                  const AdjustedPart& solved) {
  if (solved.part.tags.size() > static_cast<std::size_t>(task.options.max_tags_with_covariance))
    return std::nullopt;
  const CameraParameters known = parameters_of(refined);
  const std::vector<int> cameras = cameras_of(task.observations, solved.part);
  CameraParameters edges, lenses, places;
  if (task.options.edge_offset_sigma_px > 0.0 && std::ranges::none_of(known, is_of_edges))
    edges = edge_offset_parameters(cameras, task.options.edge_offset_sigma_px);
  if (std::ranges::none_of(known, &CameraParameter::is_of_lens))
    lenses = intrinsic_parameters(cameras, task.observations.cameras);
  if (std::ranges::none_of(known, &CameraParameter::is_of_place)) places = extrinsic_parameters(cameras);
  if (edges.empty() && lenses.empty() && places.empty()) return std::nullopt;
  const CameraFit fit(task, known + edges + lenses + places, solved.part, solved.held_tag, solved.state);
  const IsMeant is_of_lens = [](const CameraParameter& one) { return one.is_of_lens(); };
  const IsMeant is_of_place = [](const CameraParameter& one) { return one.is_of_place(); };
  const IsMeant is_in_file = [](const CameraParameter& one) { return one.is_of_lens() || one.is_of_place(); };
  /// Where one that is meant is off by more than `sigmas`.
  const auto open_where_off = [&](const IsAsked& is_asked, double sigmas, IsMeant is_meant) {
    auto open = open_parameters(fit, is_asked);
    return open && is_any_off(*open, sigmas, is_meant) ? open : std::nullopt;
  };
  std::optional<CameraRefinement> open;
  if (!places.empty()) {
    open = open_where_off([](const CameraParameter&) { return true; }, kClearlyOff, is_in_file);
    if (!open)
      open = open_where_off([&](const CameraParameter& one) { return lenses.empty() || !one.is_of_lens(); },
                            kAsExpected, is_of_place);
  }
  if (!open && !lenses.empty())
    open = open_where_off([&](const CameraParameter& one) { return places.empty() || !one.is_of_place(); },
                          kClearlyOff, is_of_lens);
  if (!open && !edges.empty()) open = open_where_off(is_of_edges, kAsExpected, is_of_edges);
  return open;
}

}  // namespace apriltrack
