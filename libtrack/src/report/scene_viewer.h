#pragma once

#include <string>

namespace apriltrack {

/// The script that draws the scenes of a page: three.js and what is in scene_viewer/. Its source is made by
/// the build.
std::string scene_viewer_script();

}  // namespace apriltrack
