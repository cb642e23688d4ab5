#include "active_tags.h"

#include <algorithm>
#include <cmath>

#include "photometric_scratch.h"

namespace apriltrack {
namespace {

constexpr std::size_t kMinPixels = 12;
constexpr int kLeastPixelsPerTag = 64;
/// Of a pixel's path, as ActiveTagsOptions::more_where_sharp: a tag of 60 px at rest then shows all its
/// pixels.
constexpr double kInstantsPaidFor = 4.0;
/// What a perfect model would still miss: print, glare, a lens that is sharper here than there.
constexpr double kModelErrorOfContrast = 0.03;
constexpr double kMinScale = 2e-3;

/// Of what is asked for, a tag's share when `num_tags` show.
int pixels_per_tag(const ActiveTagsOptions& options, std::size_t num_tags) {
  const int share = options.max_pixels_in_all / static_cast<int>(std::max<std::size_t>(1, num_tags));
  return std::min(options.max_pixels, std::max(kLeastPixelsPerTag, share));
}

bool is_chosen(const PhotometricTag& tag, TagChoice choice) {
  switch (choice) {
    case TagChoice::kAll:
      return true;
    case TagChoice::kHidden:
      return tag.is_hidden && !tag.is_passed_over;
    case TagChoice::kShown:
      break;
  }
  return !tag.is_hidden;
}

}  // namespace

void ActiveTags::find(PhotometricWorld& world, const PhotometricFrame& frame, ViewPath& path,
                      const ActiveTagsOptions& options) {
  find_in_image(world, frame, path, options);
  const int share = pixels_per_tag(options, in_image_.size());
  count_ = 0;
  for (const TagInImage& shown : in_image_) {
    ActiveTag& tag = next_slot();
    const auto num_instants = static_cast<double>(shown.prediction.num_instants());
    const double times = options.more_where_sharp ? std::max(1.0, kInstantsPaidFor / num_instants) : 1.0;
    select_pixels(world, frame.light, shown.prediction, shown.swept, options.level,
                  static_cast<int>(times * share), &tag.pixels, &tag.predicted);
    if (tag.pixels.count < kMinPixels) continue;
    tag.index = shown.index;
    tag.scale = 0.0;
    tag.prediction = &shown.prediction;
    ++count_;
  }
}

void ActiveTags::find_in_image(PhotometricWorld& world, const PhotometricFrame& frame, ViewPath& path,
                               const ActiveTagsOptions& options) {
  in_image_.clear();
  const Image<float>& image = frame.light[static_cast<std::size_t>(options.level)];
  for (const std::uint32_t k : world.scratch->nearby.of_path(path, world.max_view_angle_rad)) {
    const PhotometricTag& tag = world.tags[k];
    if (!is_chosen(tag, options.tags) || !is_front_in_sight(tag, path.middle())) continue;
    const TagSight sight(world, tag, path);
    if (!sight.is_visible()) continue;
    const SweptArea swept = swept_area(world, image, sight, tag, options.level);
    if (swept.box.isEmpty()) continue;
    const TagPrediction prediction(world, tag, sight, path, options.level, options.extra_sigma_px);
    in_image_.push_back({static_cast<int>(k), prediction, swept});
  }
}

std::span<const ActiveTag> find_active_tags(PhotometricWorld& world, const PhotometricFrame& frame,
                                            const MotionState& state, const EvidenceOptions& options) {
  ViewPath path(state, frame.exposure_s, world.mode);
  ActiveTags& active = world.scratch->active;
  active.find(world, frame, path,
              {.level = options.level,
               .max_pixels = options.max_pixels_per_tag,
               .extra_sigma_px = options.extra_sigma_px,
               .tags = options.tags});
  return active.tags();
}

TagEvidence evidence_of(const ActiveTag& tag, const TagMisfit& misfit) {
  return {.tag_index = tag.index,
          .num_pixels = static_cast<int>(tag.pixels.count),
          .area_px = tag.pixels.area_px,
          .correlation = misfit.correlation,
          .contrast = misfit.colours.gain,
          .path_px = tag.prediction->path_px(),
          .noise_share = misfit.noise_share};
}

double scale_of(const TagMisfit& misfit) {
  return std::max({misfit.residual_scale, kModelErrorOfContrast * std::abs(misfit.colours.gain), kMinScale});
}

}  // namespace apriltrack
