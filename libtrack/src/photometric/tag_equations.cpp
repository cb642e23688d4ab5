#include "apriltrack/photometric/tag_equations.h"

#include "photometric_scratch.h"

namespace apriltrack {

std::vector<TagEquations> equations_by_tag(PhotometricWorld& world, const PhotometricFrame& frame,
                                           const MotionState& state, const EvidenceOptions& options) {
  std::vector<float>& weights = world.scratch->weights;
  std::vector<TagEquations> result;
  for (const ActiveTag& tag : find_active_tags(world, frame, state, options)) {
    const double scale = scale_of(measure_misfit(tag.pixels, tag.predicted, 0.0, &weights));
    const TagMisfit misfit = measure_misfit(tag.pixels, tag.predicted, scale, &weights);
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
