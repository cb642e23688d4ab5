#include "starting_cameras.h"

#include <fmt/format.h>

#include "lens_by_single_views.h"

namespace apriltrack {
namespace {

/// Empty where they may be refined.
std::string why_they_stay(const Observations& observations, const CalibrationOptions& options) {
  if (options.intrinsics == Intrinsics::kKeep)
    return "It is kept, as --intrinsics keep says: calibrate the camera anew, or leave that option away";
  if (observations.tags.size() > static_cast<std::size_t>(options.max_tags_with_covariance))
    return fmt::format(
        "It is kept, for maps of more than {} tags keep their cameras: map some of the tags first, and give "
        "the refined camera",
        options.max_tags_with_covariance);
  return {};
}

}  // namespace

std::vector<RigCamera> starting_cameras(Observations& observations, const CalibrationOptions& options,
                                        const ParallelFor& parallel, const LogSink& log, Findings& findings) {
  const std::string why = why_they_stay(observations, options);
  std::vector<RigCamera> start = observations.cameras;
  for (std::size_t c = 0; c < start.size(); ++c) {
    const auto model = lens_by_single_views(observations, static_cast<int>(c), parallel);
    if (!model) continue;
    const std::string what =
        fmt::format("by the lens that the camera file has of {}, the tags do not look square", start[c].name);
    if (!why.empty()) {
      findings.warnings.push_back(what + ". " + why);
      continue;
    }
    log(LogLevel::kInfo, what + ": starting from one by which they do");
    start[c].model = *model;
    CameraModel& of_file = observations.cameras[c].model;
    of_file = model->distortion_name() == of_file.distortion_name()
                  ? of_file
                  : without_numbers(*model, of_file.pinhole());
  }
  return start;
}

}  // namespace apriltrack
