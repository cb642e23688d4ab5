#pragma once

#include <string>
#include <vector>

#include "apriltrack/eval/run_statistics.h"
#include "apriltrack/report/html_page.h"
#include "track_run.h"

namespace apriltrack::app {

/// INPUT, or the file of detections.
const std::string& input_name(const TrackArguments& arguments);

/// What came of the run in a few sentences.
std::string verdict(const TrackRun& run, const RunStatistics& figures);
/// Which tags were seen, which never, and which the map does not have.
std::string describe_tags(const TrackRecord& record, const TagMap& map);

/// Each tag of the map, and each that it has not: in how many frames it was what.
HtmlTable tags_of_run_table(const TrackRecord& record, const TagMap& map);

/// Times, errors claimed, exposure, latency: a line each.
HtmlTable summary_table(const TrackRun& run, const RunStatistics& figures);
/// Of the map's own uncertainty, where its tags' sigma is not small beside the claimed errors; otherwise
/// empty.
std::string describe_map_share(const TrackRun& run, const RunStatistics& figures);
/// Each status with its frames, and what its poses claim.
HtmlTable status_table(const RunStatistics& figures);
/// A sentence for each.
std::vector<std::string> meanings_of_statuses();
/// The longest stretches without evidence.
HtmlTable blind_table(const RunStatistics& figures);
HtmlTable reasons_table(const TrackRecord& record);
/// Files, method and options, defaults included.
HtmlTable settings_table(const TrackRun& run);

}  // namespace apriltrack::app
