#pragma once

#include "apriltrack/report/html_page.h"
#include "commands/track/track_truth.h"

namespace apriltrack::app {

/// Figures and charts of the run's errors.
void add_truth_section(HtmlPage& page, const TruthScore& score, const TrackRecord& record);

}  // namespace apriltrack::app
