#include "response_views.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace apriltrack {
namespace {

constexpr std::size_t kMostFramesRead = 40;
constexpr double kMostBlur_px = 1.0;  // moved, or out of focus
constexpr double kLeastExplained = 0.95;
/// Of tags whose size nobody told: the geometric mean of those that an A4 page holds, 0.03 to 0.19 m.
constexpr double kUsualSize_m = 0.075;

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
  int frame;
};

std::vector<TagPicture> pictures_of(std::span<const FrameDetections> frames, const std::string& camera,
                                    std::size_t most_pictures) {
  std::vector<const FrameDetections*> chosen;
  for (const FrameDetections& frame : frames) {
    if (frame.camera == camera && !frame.patches.empty()) chosen.push_back(&frame);
  }
  keep_evenly(chosen, kMostFramesRead);
  std::vector<TagPicture> candidates;
  for (std::size_t f = 0; f < chosen.size(); ++f) {
    for (const TagPatch& patch : chosen[f]->patches) {
      const bool is_one = std::ranges::count(chosen[f]->patches, patch.tag, &TagPatch::tag) == 1;
      const auto detection = std::ranges::find(chosen[f]->detections, patch.tag, &Detection::tag);
      if (is_one && detection != chosen[f]->detections.end())
        candidates.push_back({&*detection, &patch, static_cast<int>(f)});
    }
  }
  keep_evenly(candidates, most_pictures);
  return candidates;
}

std::optional<CodedTag> sharp_view(const TagPicture& one, const CameraModel* camera, const CodeCurve& first) {
  std::optional<CodedTag> view = CodedTag::of(*one.patch, one.detection->corners_px, camera);
  if (!view || !view->begin(first) || !view->settle(first)) return std::nullopt;
  if (view->widest_blur_px() > kMostBlur_px || view->correlation() < kLeastExplained) return std::nullopt;
  view->measure_noise();
  return view;
}

}  // namespace

std::vector<ResponseView> response_views(std::span<const FrameDetections> frames,
                                         const ResponseCamera& camera, const TagSizes& sizes,
                                         const CodeCurve& first, std::size_t most_pictures,
                                         const ParallelFor& parallel) {
  const std::vector<TagPicture> candidates = pictures_of(frames, camera.name, most_pictures);
  const CameraModel* model = camera.model ? &*camera.model : nullptr;
  std::vector<std::optional<CodedTag>> found(candidates.size());
  parallel(candidates.size(), [&](std::size_t i) { found[i] = sharp_view(candidates[i], model, first); });
  std::vector<ResponseView> views;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const TagKey& tag = candidates[i].patch->tag;
    if (found[i])
      views.push_back(
          {std::move(*found[i]), tag, 0.5 * sizes.find(tag).value_or(kUsualSize_m), candidates[i].frame});
  }
  return views;
}

}  // namespace apriltrack
