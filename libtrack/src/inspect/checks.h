#pragma once

#include <span>
#include <string>
#include <vector>

#include "apriltrack/inspect/finding.h"
#include "apriltrack/inspect/recording_facts.h"
#include "apriltrack/inspect/tag_summary.h"

namespace apriltrack {

// Each looks for one kind of fault, and returns what it finds.

/// Whether images can be read, are of one size, follow each other in time, and are well exposed.
std::vector<RecordingFinding> check_images(const RecordingFacts& recording);
/// Whether recordings that are said to be of one camera are of one size.
std::vector<RecordingFinding> check_sizes(const InspectionFacts& facts);
/// Whether the camera file fits the images, and is plausible.
std::vector<RecordingFinding> check_camera(const RecordingFacts& recording);
/// Whether too many frames are blurred.
std::vector<RecordingFinding> check_blur(const RecordingFacts& recording);
/// Whether pictures of tags contradict the camera's response, or leave it in doubt.
std::vector<RecordingFinding> check_response(const RecordingFacts& recording);
/// Whether tags look square by the lens of the camera file.
std::vector<RecordingFinding> check_lens(const RecordingFacts& recording);
/// Whether tags are seen together from more places than one.
std::vector<RecordingFinding> check_viewpoints(const InspectionFacts& facts);
/// Whether pictures are mirrored, or light and dark exchanged; and what was read and left out.
/// families: asked for.
std::vector<RecordingFinding> check_odd_pictures(const RecordingFacts& recording,
                                                 std::span<const std::string> families);
/// Whether there are tags of the families asked for, or of others.
std::vector<RecordingFinding> check_families(const InspectionFacts& facts);
/// Whether tags are joined by common views, seen often enough, large enough and unique.
std::vector<RecordingFinding> check_tags(std::span<const TagSummary> tags,
                                         std::span<const std::vector<TagKey>> parts);

}  // namespace apriltrack
