#pragma once

#include <vector>

#include "demo_plan.h"
#include "demo_scores.h"

namespace apriltrack::app {

/// Draws the pictures and writes the page that holds the table, the pictures and the videos. Throws Error.
void write_demo_report(const DemoOptions& options, const DemoFiles& files,
                       const std::vector<DemoScore>& scores);

}  // namespace apriltrack::app
