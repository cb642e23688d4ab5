#include "model/view_candidates.h"

#include <cmath>

#include "apriltrack/geometry/planar_pnp.h"

namespace apriltrack {
namespace {

// The weight stays well above zero: what other views say must be able to overrule one view's residuals, which
// carry biases (blur, lens model) that are larger than the corner noise.
// Twice the expected corner sigma (0.15 px), for those biases' sake.
constexpr double kViewErrorScale_px = 0.3;
constexpr double kMinWeight = 0.05;

ViewCandidates solve_view(const TagView& view, const RigCamera& camera, double size_m) {
  ViewCandidates result;
  const auto rays = corner_rays(camera.model, view.corners_px);
  if (!rays) return result;
  const Pose T_rig_camera = camera.T_camera_rig.inverse();
  const PlanarPoses poses = solve_planar_pnp(*rays, size_m);
  for (const PlanarPose& pose : poses) {
    const double error = pose.rms_error_rad * camera.model.pinhole().fx / kViewErrorScale_px;
    const double best = poses[0].rms_error_rad * camera.model.pinhole().fx / kViewErrorScale_px;
    const double likelihood_ratio = std::exp(-0.5 * 8.0 * (error * error - best * best));
    result.candidates.push_back({T_rig_camera * pose.T_camera_tag, std::max(kMinWeight, likelihood_ratio)});
  }
  return result;
}

}  // namespace

std::vector<ViewCandidates> solve_views(const Observations& observations,
                                        const std::vector<std::size_t>& views, const ParallelFor& parallel) {
  std::vector<ViewCandidates> result(observations.views.size());
  parallel(views.size(), [&](std::size_t i) {
    const TagView& view = observations.views[views[i]];
    result[views[i]] = solve_view(view, observations.cameras[static_cast<std::size_t>(view.camera)],
                                  observations.sizes_m[static_cast<std::size_t>(view.tag)]);
  });
  return result;
}

}  // namespace apriltrack
