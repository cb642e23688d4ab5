#include "initialise/starting_cameras.h"

#include "apriltrack/calib/calibration_options.h"
#include "initialise/lens_by_single_views.h"

namespace apriltrack {
namespace {

using Why = LensDoubt::Why;

Why what_becomes_of_lenses(const Observations& observations, const CalibrationOptions& options) {
  if (options.intrinsics == Intrinsics::kKeep) return Why::kKeptByOption;
  const bool are_many = observations.tags.size() > static_cast<std::size_t>(options.max_tags_with_covariance);
  return are_many ? Why::kKeptForManyTags : Why::kReplaced;
}

}  // namespace

std::vector<RigCamera> starting_cameras(Observations& observations, const CalibrationOptions& options,
                                        const ParallelFor& parallel, std::vector<LensDoubt>& doubts) {
  const Why why = what_becomes_of_lenses(observations, options);
  std::vector<RigCamera> start = observations.cameras;
  for (std::size_t c = 0; c < start.size(); ++c) {
    const auto model = lens_by_single_views(observations, static_cast<int>(c), parallel);
    if (!model) continue;
    doubts.push_back({static_cast<int>(c), why});
    if (why != Why::kReplaced) continue;
    start[c].model = *model;
    CameraModel& of_file = observations.cameras[c].model;
    of_file = model->distortion_name() == of_file.distortion_name()
                  ? of_file
                  : without_numbers(*model, of_file.pinhole());
  }
  return start;
}

}  // namespace apriltrack
