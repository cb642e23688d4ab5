#include "initialise/lens_by_single_views.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "initialise/lens_fit.h"

namespace apriltrack {
namespace {

constexpr std::size_t kMostViewsForLens = 2000;
constexpr double kPlace_px = 24.0;  // a tag that is seen there again says the same once more
constexpr int kMostLensSteps = 30;
constexpr double kStillLens = 0.01;         // of what a number is known by
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
    if (!fit.move(step, noise, lens) || step.cwiseAbs().maxCoeff() < kStillLens) break;
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
  LensFit fit(observations, camera, views, parallel);
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
  LensFit fit(observations, of_file, views, parallel);
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
