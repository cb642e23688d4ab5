#pragma once

#include <span>
#include <vector>

#include "apriltrack/detect/detector.h"
#include "apriltrack/image/image.h"
#include "console.h"
#include "doctor_facts.h"

namespace apriltrack::app {

/// Looks for every family that `asked` does not name, all in one search of each image; what a family asked
/// for reads as well, or better, does not count. Returns those that were read, chance readings among them
/// (is_surely_there), in the order of their names. Ctrl-C ends it.
std::vector<FamilyReadings> read_other_families(std::span<const GrayImage> images,
                                                const DetectorOptions& asked, int num_threads,
                                                const Console& console);

}  // namespace apriltrack::app
