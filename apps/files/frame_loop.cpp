#include "frame_loop.h"

#include <nlohmann/json.hpp>
#include <utility>

namespace apriltrack::app {

nlohmann::json value_range_json(const std::optional<ValueRange>& range) {
  if (!range) return nullptr;
  const std::optional<int> bits = range->bits();
  return {{"black", range->black}, {"white", range->white}, {"bits", bits ? nlohmann::json(*bits) : nullptr}};
}

FrameCounts detect_frames(FrameSource& source, DetectFramesOptions options, const Console& console,
                          const std::function<void(DetectedFrame)>& sink) {
  options.progress = progress_on(console);
  options.should_stop = is_interrupted;
  FrameCounts counts = apriltrack::detect_frames(source, options, sink);
  for (const std::string& warning : counts.warnings()) console.warning(warning);
  if (counts.is_interrupted) console.warning(kInterrupted);
  return counts;
}

}  // namespace apriltrack::app
