#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "doctor_facts.h"
#include "doctor_tags.h"

namespace apriltrack::app {

enum class Severity {
  kStops,    ///< `calibrate` would end without a map, or refuse its input.
  kWarning,  ///< It would go on, to a worse or a smaller map.
  kNote,     ///< Good to know.
};

/// Something that the user should know, with the way out.
struct Finding {
  Severity severity = Severity::kNote;
  std::string about;  ///< A fixed word for programs, such as "mixed_resolutions" (docs/file_formats.md).
  std::string text;
};

/// How the frames follow each other in time.
struct FrameTimes {
  std::optional<double> rate_hz = std::nullopt;  ///< By the median interval; none of fewer than two frames.
  std::size_t gaps = 0;                          ///< Intervals of more than 2.5 times the median.
  double longest_gap_s = 0.0;                    ///< 0 without gaps.
  std::size_t not_forward = 0;                   ///< Frames that are no later than the one before.
};
FrameTimes frame_times(std::span<const FrameFacts> frames);

/// How many readable images there are of a size.
struct ImageSize {
  int width = 0;
  int height = 0;
  std::size_t frames = 0;
};
/// The commonest first.
std::vector<ImageSize> image_sizes(std::span<const FrameFacts> frames);

/// False where chance explains readings of codes in what is no tag: of families with few bits unless one id
/// comes back frame after frame with a clear margin. sampled: frames that were looked at.
bool is_surely_there(const FamilyReadings& readings, std::size_t sampled);

std::vector<Finding> find_in_images(const RecordingFacts& recording);
/// Whether recordings that are said to be of one camera are of one size.
std::vector<Finding> find_in_sizes(const Facts& facts);
std::vector<Finding> find_in_camera(const RecordingFacts& recording);
std::vector<Finding> find_in_blur(const RecordingFacts& recording);
/// Whether pictures of tags contradict the camera's response, or leave it in doubt.
std::vector<Finding> find_in_response(const RecordingFacts& recording);
/// Of the lens, by how square the tags look.
std::vector<Finding> find_in_lens(const RecordingFacts& recording);
/// Whether tags are seen together from more places than one.
std::vector<Finding> find_in_places(const Facts& facts);
/// Whether pictures are mirrored, or light and dark exchanged; and what was read and left out.
/// families: asked for.
std::vector<Finding> find_in_odd_pictures(const RecordingFacts& recording,
                                          std::span<const std::string> families);
/// Of the families that no one asked for, and of none that was.
std::vector<Finding> find_in_families(const Facts& facts);
std::vector<Finding> find_in_tags(std::span<const TagSummary> tags,
                                  std::span<const std::vector<TagKey>> parts);

/// All of the above: what stops first, then warnings, then notes. Where there are several recordings, texts
/// begin with the one they are about.
std::vector<Finding> find_all(const Facts& facts);

enum class Readiness { kReady, kReadyWithWarnings, kNotReady };

struct Verdict {
  Readiness readiness = Readiness::kReady;
  std::string text;  ///< One line, for people.
};
/// has_tags: any of the family asked for.
Verdict verdict_of(std::span<const Finding> findings, bool has_tags);

}  // namespace apriltrack::app
