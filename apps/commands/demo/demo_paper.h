#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "demo_plan.h"
#include "demo_scores.h"

namespace apriltrack::app {

/// What the paper's filter works with, as its figures 3 and 5: the reference patches of the bundle's tags,
/// and the cloud of particles in the most blurred frame that weighed it, coloured by weight. Returns which
/// frame that is, in words; `scores` tell the blur. Throws Error.
std::string draw_paper_pictures(const DemoFiles& files, const std::vector<DemoScore>& scores,
                                std::uint64_t seed, const std::filesystem::path& patches,
                                const std::filesystem::path& cloud);

}  // namespace apriltrack::app
