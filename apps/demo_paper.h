#pragma once

#include <cstdint>
#include <filesystem>

#include "demo_plan.h"

namespace apriltrack::app {

/// What the paper's filter works with, as its figures 3 and 5: the reference patches of the bundle's tags,
/// and the cloud of particles in a blurred frame, coloured by weight. Throws Error.
void draw_paper_pictures(const DemoFiles& files, std::uint64_t seed, const std::filesystem::path& patches,
                         const std::filesystem::path& cloud);

}  // namespace apriltrack::app
