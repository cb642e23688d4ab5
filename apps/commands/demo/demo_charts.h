#pragma once

#include <filesystem>
#include <vector>

#include "demo_scores.h"

namespace apriltrack::app {

/// Corner error of every method in one scene, frame by frame; frames without a pose leave a gap. Throws
/// Error(kIo).
void draw_error_over_time(const std::filesystem::path& picture, const DemoScene& scene,
                          const std::vector<DemoScore>& scores);

/// The same errors against the frame's motion blur. Throws Error(kIo).
void draw_error_against_blur(const std::filesystem::path& picture, const DemoScene& scene,
                             const std::vector<DemoScore>& scores);

}  // namespace apriltrack::app
