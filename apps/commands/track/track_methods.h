#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apriltrack/detect/detection.h"
#include "apriltrack/image/frame.h"
#include "apriltrack/tracker/localizer.h"
#include "cli/console.h"

namespace apriltrack::app {

struct MethodOptions {
  std::string name;            ///< blur, paper or pnp.
  LocalizerOptions localizer;  ///< mode and detector hold for every method.
  std::string paper_variant = "printed";
  std::optional<std::size_t> num_particles;
  std::uint64_t seed = 1;
  int num_threads = 0;
};

/// A way to track: what it detects with, and what it makes of a frame.
struct Method {
  std::optional<DetectorOptions> detector;  ///< None: it looks for tags itself, where it needs them.
  DetectorOptions looks_for;                ///< What it detects with in either case.
  /// detections: empty without a detector.
  std::function<TrackResult(const Frame&, const std::vector<Detection>&)> track;
};

/// Warns of what the method misses in the camera's file; `console` must outlive it.
Method make_method(const MethodOptions& options, const Camera& camera, const TagMap& map,
                   const Console& console);

}  // namespace apriltrack::app
