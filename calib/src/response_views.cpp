#include "response_views.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "apriltrack/geometry/planar_pnp.h"
#include "apriltrack/tags/tag_family.h"

namespace apriltrack {
namespace {

constexpr std::size_t kMostFramesRead = 40;
constexpr std::size_t kMostPixelsOfTag = 1500;
constexpr double kBlurToRead_px = 0.8;
constexpr double kMostLensBlur_px = 1.0;  // moved, or out of focus
constexpr double kLeastExplained = 0.95;

template <class T>
void keep_evenly(std::vector<T>& all, std::size_t most) {
  if (all.size() <= most) return;
  std::vector<T> kept;
  for (std::size_t i = 0; i < most; ++i) kept.push_back(std::move(all[i * all.size() / most]));
  all = std::move(kept);
}

struct TagPicture {
  const Detection* detection;
  const TagPatch* patch;
  double size_m;
  int frame;
};

std::vector<TagPicture> pictures_of(std::span<const FrameDetections> frames, const Camera& camera,
                                    const TagSizes& sizes, std::size_t most_pictures) {
  std::vector<const FrameDetections*> chosen;
  for (const FrameDetections& frame : frames) {
    if (frame.camera == camera.name && !frame.patches.empty()) chosen.push_back(&frame);
  }
  keep_evenly(chosen, kMostFramesRead);
  std::vector<TagPicture> candidates;
  for (std::size_t f = 0; f < chosen.size(); ++f) {
    for (const TagPatch& patch : chosen[f]->patches) {
      const auto size_m = sizes.find(patch.tag);
      const bool is_one = std::ranges::count(chosen[f]->patches, patch.tag, &TagPatch::tag) == 1;
      const auto detection = std::ranges::find(chosen[f]->detections, patch.tag, &Detection::tag);
      if (size_m && is_one && detection != chosen[f]->detections.end())
        candidates.push_back({&*detection, &patch, *size_m, static_cast<int>(f)});
    }
  }
  keep_evenly(candidates, most_pictures);
  return candidates;
}

std::optional<ResponseView> sharp_view(const TagPicture& one, const Camera& coded, const CameraModel& model,
                                       const CodeCurve& first) {
  const auto rays = corner_rays(model, one.detection->corners_px);
  if (!rays) return std::nullopt;
  const PlanarPoses poses = solve_planar_pnp(*rays, one.size_m);
  if (poses.empty()) return std::nullopt;
  const TagKey& key = one.patch->tag;
  const PrintedTag tag{TagFamily::get(key.family).pattern(key.id), 0.5 * one.size_m};
  PhotometricView pixels;
  if (!read_pixels(*one.patch, coded, tag, poses[0].T_camera_tag, kBlurToRead_px, pixels))
    return std::nullopt;
  keep_evenly(pixels.light, kMostPixelsOfTag);
  keep_evenly(pixels.rays, kMostPixelsOfTag);
  ResponseView result{CodedView(std::move(pixels), model, tag, poses[0].T_camera_tag), key, one.frame};
  if (!result.view.begin(first) || !result.view.settle(first)) return std::nullopt;
  const bool is_sharp =
      result.view.psf_sigma_px() < kMostLensBlur_px && result.view.correlation() > kLeastExplained;
  if (!is_sharp) return std::nullopt;
  result.view.measure_noise();
  return result;
}

}  // namespace

std::vector<ResponseView> response_views(std::span<const FrameDetections> frames, const Camera& camera,
                                         const TagSizes& sizes, const CodeCurve& first,
                                         std::size_t most_pictures, const ParallelFor& parallel) {
  Camera coded = camera;  // its light is the grey levels
  coded.response = ResponseCurve::linear();
  const std::vector<TagPicture> candidates = pictures_of(frames, camera, sizes, most_pictures);
  std::vector<std::optional<ResponseView>> found(candidates.size());
  parallel(candidates.size(),
           [&](std::size_t i) { found[i] = sharp_view(candidates[i], coded, camera.model, first); });
  std::vector<ResponseView> views;
  for (std::optional<ResponseView>& one : found) {
    if (one) views.push_back(std::move(*one));
  }
  return views;
}

}  // namespace apriltrack
