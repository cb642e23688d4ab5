#pragma once

#include <filesystem>

namespace apriltrack::app {

struct BlindnessFigures {
  int frames = 0;  ///< With a tag in view.
  int right = 0;   ///< With a pose within 5 px.
  int wrong = 0;   ///< With a pose farther off.
  int blind = 0;   ///< Without a pose.
};

/// Draws how detection fared in a sequence folder with truth: blur and outcome of every frame, and three
/// example frames from sharp to blurred with the tags outlined where they truly are. Throws Error.
BlindnessFigures draw_blindness_picture(const std::filesystem::path& sequence,
                                        const std::filesystem::path& estimate,
                                        const std::filesystem::path& picture);

}  // namespace apriltrack::app
