#include "apriltrack/photometric/tag_equations.h"

#include "photometric_scratch.h"

namespace apriltrack {

std::vector<TagEquations> equations_by_tag(PhotometricWorld& world, const PhotometricFrame& frame,
                                           const MotionState& state, const EvidenceOptions& options) {
  PhotometricScratch& scratch = *world.scratch;
  ViewPath path(state, frame.exposure_s, world.mode);
  scratch.active.find(world, frame, path,
                      {.level = options.level,
                       .max_pixels = options.max_pixels_per_tag,
                       .extra_sigma_px = options.extra_sigma_px,
                       .tags = options.tags});
  std::vector<TagEquations> result;
  for (const ActiveTag& tag : scratch.active.tags()) {
    const double scale = scale_of(measure_misfit(tag.pixels, tag.predicted, 0.0, &scratch.weights));
    const TagMisfit misfit = measure_misfit(tag.pixels, tag.predicted, scale, &scratch.weights);
    TagEquations one{.evidence = evidence_of(tag, misfit)};
    if (misfit.colours.gain > 0.0) {
      const TagNormalEquations normal = linearise(tag.pixels, *tag.prediction, misfit.colours, scale);
      one.H = tag.pixels.information_share() * normal.H;
      one.g = tag.pixels.information_share() * normal.g;
    }
    result.push_back(one);
  }
  return result;
}

}  // namespace apriltrack
