#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "apriltrack/image/image.h"

namespace apriltrack {

struct LabelledPatch {
  Image<float> cells;  ///< Grey levels, 0 black to 255 white; NaN where not known, drawn as a pale hatch.
  std::string caption;
};

/// Writes the patches as a PNG file, in rows, each enlarged by whole pixels without smoothing and with its
/// caption below. Requires at least one patch, and no empty one. Throws Error(kIo).
void write_patch_sheet(const std::filesystem::path& path, const std::string& title,
                       std::span<const LabelledPatch> patches);

}  // namespace apriltrack
