#include "track_methods.h"

#include <fmt/format.h>

#include <memory>

#include "apriltrack/base/error.h"
#include "apriltrack/tracker/blur_tracker.h"
#include "apriltrack/tracker/paper_tracker.h"

namespace apriltrack::app {
namespace {

Method pnp_method(const MethodOptions& options, const Camera& camera, const TagMap& map) {
  const auto localizer = std::make_shared<Localizer>(camera, map, options.localizer);
  return {localizer->detector_options(), localizer->detector_options(),
          [=](const Frame& frame, const std::vector<Detection>& detections) {
            return localizer->localize({frame.timestamp, "", detections}, frame.exposure_s);
          }};
}

Method paper_method(const MethodOptions& given, const Camera& camera, const TagMap& map) {
  const bool is_printed = given.paper_variant == "printed";
  auto options = PaperTrackerOptions::published(is_printed ? PaperVariant::kPrinted : PaperVariant::kProgram);
  options.localizer = given.localizer;
  options.filter.num_particles = given.num_particles.value_or(options.filter.num_particles);
  options.filter.seed = given.seed;
  options.num_threads = given.num_threads;
  const auto tracker = std::make_shared<PaperTracker>(camera, map, options);
  return {tracker->detector_options(), tracker->detector_options(),
          [=](const Frame& frame, const std::vector<Detection>& detections) {
            return tracker->track(frame, detections);
          }};
}

Method blur_method(const MethodOptions& given, const Camera& camera, const TagMap& map,
                   const Console& console) {
  constexpr std::size_t kFewest = 16;
  if (given.num_particles && *given.num_particles < kFewest) {
    throw invalid_input("--particles", fmt::format("must be at least {} for --method blur (is {})", kFewest,
                                                   *given.num_particles));
  }
  BlurTrackerOptions options;
  options.mode = given.localizer.mode;
  options.detector = given.localizer.detector;
  options.num_particles =
      static_cast<int>(given.num_particles.value_or(static_cast<std::size_t>(options.num_particles)));
  options.seed = given.seed;
  const auto tracker = std::make_shared<BlurTracker>(camera, map, options);
  // Frames of a recording may bring an exposure each: told once, by the first that does not.
  const auto has_warned = std::make_shared<bool>(camera.exposure_s.has_value());
  tracker->prepare();
  return {
      std::nullopt, tracker->detector_options(),
      [=, &console](const Frame& frame, const std::vector<Detection>&) {
        if (!frame.exposure_s && !*has_warned) {
          console.warning(fmt::format(
              "no exposure is known: {} s is assumed until the motion tells; blur fits the worse the more it "
              "is off: give exposure_time in the camera file",
              options.default_exposure_s));
          *has_warned = true;
        }
        return tracker->track(frame);
      }};
}

}  // namespace

Method make_method(const MethodOptions& options, const Camera& camera, const TagMap& map,
                   const Console& console) {
  if (options.name == "paper") return paper_method(options, camera, map);
  if (options.name == "pnp") return pnp_method(options, camera, map);
  return blur_method(options, camera, map, console);
}

}  // namespace apriltrack::app
