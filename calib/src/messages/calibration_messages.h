#pragma once

#include <string>
#include <vector>

#include "apriltrack/base/log.h"
#include "apriltrack/calib/calibration_finding.h"
#include "apriltrack/calib/calibration_options.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detection.h"
#include "observations/resting_frames.h"
#include "solution/part_solution.h"

namespace apriltrack {

// What a calibration found, as a user gets it.

using Findings = std::vector<CalibrationFinding>;

CalibrationFinding to_finding(CalibrationFinding::Kind kind, std::string message);

/// Names the tags as left out, with the reason; nothing where there are none.
void leave_out(CalibrationFinding::Kind kind, const Observations& observations, const std::vector<int>& tags,
               const std::string& reason, Findings& findings);
/// Sorted, each once.
std::vector<TagKey> tags_left_out(const Findings& findings);

/// Corners that seem to be of pictures of another size than a camera has.
void report_picture_sizes(std::span<const FrameDetections> frames, const CameraRig& rig, Findings& findings);

void report_unused(const UnusedDetections& unused, Findings& findings);

/// What to know of a part that was solved: faults of tags, what went, residuals.
void report_quality(const Observations& observations, const PartSolution& solution,
                    const CalibrationOptions& options, Findings& findings);

/// By what a map may be folded or off, and constraints broken without being wrong.
std::vector<std::string> doubts_of_map(const Observations& observations, const PartSolution& solution);

/// parts: all but the first are not in the map.
void report_other_parts(const Observations& observations, const std::vector<Part>& parts, Findings& findings);

void report_repeated_frames(int num_frames, Findings& findings);

/// moments_before: how many there were. A finding where most are at rest, and else talk.
void report_resting_frames(const RestingFrames& resting, std::size_t moments_before, Findings& findings,
                           const LogSink& log);

/// Tags whose stated size is hardly one in metres: centimetres or millimetres are the commonest slip, and no
/// view can tell.
void report_unusual_sizes(const Observations& observations, const std::vector<Part>& parts,
                          Findings& findings);

/// What constraints are not used, or in doubt.
void report_constraints(const ConstraintNotes& notes, Findings& findings);

/// Of `tags`, which stay as the corners have them.
void report_unrefined(const std::vector<TagKey>& tags, Findings& findings);

}  // namespace apriltrack
