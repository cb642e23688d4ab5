#pragma once

#include <string>
#include <vector>

#include "commands/track/page/track_run.h"
#include "files/camera_response.h"
#include "files/corner_claims.h"
#include "files/outputs.h"
#include "frame_sinks.h"
#include "track_options.h"
#include "track_record.h"

namespace apriltrack::app {

/// All files that a run is to write.
std::vector<OutputFile> output_files(const TrackArguments& arguments);

/// Whether the frame log is to be written: one of a run without a pose replaces none of a run with poses. To
/// be asked before it is written.
bool writes_frame_log(const TrackArguments& arguments, const TrackRecord& record);
/// Where a run without a pose says more than its error; as the end of that.
std::string told_of_frame_log(const TrackArguments& arguments, bool is_written);

/// A run without a pose leaves what says why, the page and the frame log; others all that was asked for, or
/// nothing.
void write_outputs(const TrackArguments& arguments, const TrackRun& tracked, bool with_frame_log,
                   FrameSinks& sinks);

/// The answer.
void finish(const TrackArguments& arguments, const TrackRecord& record, const ResponseFinding& response,
            const CornerClaims& claims, bool was_interrupted);

}  // namespace apriltrack::app
