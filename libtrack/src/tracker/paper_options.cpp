#include <fmt/format.h>

#include "apriltrack/base/error.h"
#include "apriltrack/tracker/paper_tracker.h"

namespace apriltrack {

std::string_view to_string(PaperVariant variant) {
  return variant == PaperVariant::kPrinted ? "printed" : "program";
}

PaperTrackerOptions PaperTrackerOptions::published(PaperVariant variant) {
  PaperTrackerOptions options;
  options.likelihood.tag_template = TagTemplate::kReference;
  options.likelihood.grid.half_extent = 0.1936 / 0.1635;  // tau of a 0.1635 m tag: some margin in
  options.likelihood.gamma = 10.0;
  if (variant == PaperVariant::kPrinted) {
    options.likelihood.grid.size = 32;
    options.likelihood.error = PatchError::kLinear;
    options.filter.num_particles = 3000;
    options.filter.noise = {
        .position_m = 0.01, .rotation_rad = 0.05, .velocity_m = 0.02, .angular_velocity_rad = 0.0};
  } else {
    options.likelihood.grid.size = 64;
    options.likelihood.error = PatchError::kMinusLog;
    options.likelihood.average_over_tags = true;
    options.filter.num_particles = 6000;
    options.filter.noise = {
        .position_m = 0.005, .rotation_rad = 0.03, .velocity_m = 0.01, .angular_velocity_rad = 0.03};
    options.filter.moves_with_new_velocity = true;
    options.discard_correlation = 0.33;  // exp(-1.1)
  }
  return options;
}

void PaperTrackerOptions::check() const {
  localizer.check();
  filter.check();
  likelihood.check();
  if (likelihood.tag_template != TagTemplate::kReference)
    throw invalid_input("tag_template", "must be kReference: the paper compares with earlier views");
  if (!(discard_correlation >= -1.0 && discard_correlation < 1.0)) {
    throw invalid_input("discard_correlation",
                        fmt::format("must lie in [-1, 1) (is {})", discard_correlation));
  }
  if (!(min_correlation > 0.0 && min_correlation < 1.0))
    throw invalid_input("min_correlation", fmt::format("must lie in (0, 1) (is {})", min_correlation));
  if (num_threads < 0 || num_threads > 1024)
    throw invalid_input("num_threads", fmt::format("must lie in [0, 1024] (is {})", num_threads));
}

}  // namespace apriltrack
