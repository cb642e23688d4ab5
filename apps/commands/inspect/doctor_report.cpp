#include "doctor_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "apriltrack/inspect/recording_summary.h"
#include "apriltrack/inspect/tag_summary.h"
#include "files/camera_response.h"
#include "files/frame_loop.h"
#include "files/left_out_words.h"

namespace apriltrack::app {
namespace {

std::size_t frames_with_tags(const RecordingFacts& recording) {
  return static_cast<std::size_t>(
      std::ranges::count_if(recording.frames, [](const FrameFacts& frame) { return !frame.tags.empty(); }));
}

double percent(std::size_t some, std::size_t all) {
  return all == 0 ? 0.0 : 100.0 * static_cast<double>(some) / static_cast<double>(all);
}

std::string told_images(const RecordingFacts& recording) {
  std::vector<std::string> sizes;
  for (const ImageSizeCount& size : image_sizes(recording.frames))
    sizes.push_back(fmt::format("{} x {}", size.width, size.height));
  std::string text =
      fmt::format("{}: {} frames of {}", recording.input, recording.frames.size(), fmt::join(sizes, ", "));
  const FrameTimes times = frame_times(recording.frames);
  if (recording.tells_times && times.rate_hz) text += fmt::format(", {:.3g} a second", *times.rate_hz);
  if (times.gaps > 0) text += fmt::format(" with {} gaps", times.gaps);
  if (recording.unreadable > 0) text += fmt::format(", {} unreadable", recording.unreadable);
  const std::size_t tagged = frames_with_tags(recording);
  return text +
         fmt::format("\n  tags in {} frames ({:.0f} %)\n", tagged, percent(tagged, recording.frames.size()));
}

std::string told_exposure(const RecordingFacts& recording) {
  const auto told =
      static_cast<std::size_t>(std::ranges::count_if(recording.frames, &FrameFacts::tells_exposure));
  if (told > 0) return fmt::format("exposure told of {} frames", told);
  if (recording.camera && recording.camera->exposure_s)
    return fmt::format("exposure {:g} ms", 1e3 * *recording.camera->exposure_s);
  return "exposure not told";
}

std::string told_camera(const RecordingFacts& recording) {
  if (!recording.camera) return fmt::format("  no camera file; {}\n", told_exposure(recording));
  const Camera& camera = *recording.camera;
  const Pinhole& pinhole = camera.model.pinhole();
  const std::string size =
      camera.width > 0 ? fmt::format("{} x {}", camera.width, camera.height) : "no resolution told";
  return fmt::format(
      "  camera '{}': {}, focal lengths {:.1f} and {:.1f} px, {}, {}\n", camera.name, size, pinhole.fx,
      pinhole.fy, told_exposure(recording),
      camera.line_delay_s == 0.0 ? "no line delay told (taken for a global shutter)" : "rolling shutter");
}

std::string told_response(const RecordingFacts& recording) {
  if (frames_with_tags(recording) == 0) return "";
  return fmt::format("  response: {}\n", words_of(recording.response));
}

std::string told_blur(const RecordingFacts& recording) {
  const BlurCounts counts = count_blur(recording.frames);
  if (!counts.median_px) return "";
  const std::size_t all = counts.measured();
  std::string text = fmt::format(
      "  blur of the tags' edges: median {:.1f} px, at most {:.1f}; of the frames with tags {:.0f} % are "
      "sharp (below {:g} px), {:.0f} % soft, {:.0f} % blurred ({:g} px and more)\n",
      *counts.median_px, *counts.worst_px, percent(counts.sharp, all), kSharpBelow_px,
      percent(counts.soft, all), percent(counts.blurred, all), kBlurredFrom_px);
  if (counts.unread > 0)
    text += fmt::format("  no tag can be read in {} frames between these\n", counts.unread);
  return text;
}

std::string told_tags(std::span<const TagSummary> tags, std::size_t frames) {
  if (tags.empty()) return "";
  std::string text = fmt::format("{:<20} {:>7} {:>6} {:>9} {:>8} {:>11} {:>7} {:>8}\n", "tag", "frames", "%",
                                 "places", "edge px", "range px", "margin", "blur px");
  for (const TagSummary& tag : tags)
    text +=
        fmt::format("{:<20} {:>7} {:>6.1f} {:>9} {:>8.1f} {:>11} {:>7.0f} {:>8}\n", to_string(tag.tag),
                    tag.frames, percent(tag.frames, frames), tag.places_together, tag.median_edge_px,
                    fmt::format("{:.0f}-{:.0f}", tag.smallest_edge_px, tag.largest_edge_px),
                    tag.median_margin, tag.median_blur_px ? fmt::format("{:.1f}", *tag.median_blur_px) : "-");
  return text;
}

std::string told_parts(std::span<const std::vector<TagKey>> parts) {
  if (parts.size() == 1 && parts.front().size() > 1)
    return fmt::format("all {} tags are joined by frames that show two or more of them\n",
                       parts.front().size());
  return "";
}

std::size_t num_frames(const InspectionFacts& facts) {
  std::size_t frames = 0;
  for (const RecordingFacts& recording : facts.recordings) frames += recording.frames.size();
  return frames;
}

const char* word_of(FindingSeverity severity) {
  switch (severity) {
    case FindingSeverity::kStops:
      return "stops";
    case FindingSeverity::kWarning:
      return "warning";
    case FindingSeverity::kNote:
      return "note";
  }
  return "";
}

const char* word_of(CalibrationReadiness readiness) {
  switch (readiness) {
    case CalibrationReadiness::kReady:
      return "ready";
    case CalibrationReadiness::kReadyWithWarnings:
      return "ready_with_warnings";
    case CalibrationReadiness::kNotReady:
      return "not_ready";
  }
  return "";
}

nlohmann::json or_null(const std::optional<double>& value) {
  return value ? nlohmann::json(*value) : nlohmann::json();
}

nlohmann::json json_of(const RecordingFacts& recording) {
  nlohmann::json sizes = nlohmann::json::array();
  for (const ImageSizeCount& size : image_sizes(recording.frames))
    sizes.push_back({{"width", size.width}, {"height", size.height}, {"frames", size.frames}});
  const FrameTimes times = frame_times(recording.frames);
  const BlurCounts blur = count_blur(recording.frames);
  nlohmann::json families = nlohmann::json::array();
  for (const FamilyReadings& other : recording.other_families)
    families.push_back({{"family", other.family},
                        {"readings", other.readings},
                        {"frames", other.frames},
                        {"by_chance", !is_surely_there(other, recording.sampled)}});
  return {{"input", recording.input},
          {"camera", recording.camera_name},
          {"frames", recording.frames.size()},
          {"frames_with_tags", frames_with_tags(recording)},
          {"unreadable", recording.unreadable},
          {"sizes", sizes},
          {"value_range", value_range_json(recording.value_range)},
          {"rate_hz", recording.tells_times ? or_null(times.rate_hz) : nlohmann::json()},
          {"time_gaps", times.gaps},
          {"longest_gap_s", times.longest_gap_s},
          {"blur",
           {{"median_px", or_null(blur.median_px)},
            {"worst_px", or_null(blur.worst_px)},
            {"frames_sharp", blur.sharp},
            {"frames_soft", blur.soft},
            {"frames_blurred", blur.blurred},
            {"frames_unread", blur.unread}}},
          {"response", app::json_of(recording.response)},
          {"readings_left_out", app::json_of(recording.left_out)},
          {"frames_sampled", recording.sampled},
          {"other_families", families}};
}

nlohmann::json json_of(const TagSummary& tag) {
  return {{"tag", to_string(tag.tag)},
          {"frames", tag.frames},
          {"places_together", tag.places_together},
          {"frames_twice", tag.frames_twice},
          {"edge_px", {tag.smallest_edge_px, tag.median_edge_px, tag.largest_edge_px}},
          {"decision_margin", tag.median_margin},
          {"blur_px", or_null(tag.median_blur_px)}};
}

}  // namespace

std::string told_facts(const InspectionFacts& facts, std::span<const RecordingFinding> findings,
                       const CalibrationVerdict& verdict) {
  std::string text;
  for (const RecordingFacts& recording : facts.recordings)
    text += told_images(recording) + told_camera(recording) + told_response(recording) + told_blur(recording);
  text += told_tags(summarise_tags(facts), num_frames(facts));
  text += told_parts(joined_parts(facts.places));
  for (const RecordingFinding& finding : findings)
    if (finding.severity == FindingSeverity::kNote) text += "note: " + finding.text + "\n";
  return text + "verdict: " + verdict.text;
}

nlohmann::json json_of(const InspectionFacts& facts, std::span<const RecordingFinding> findings,
                       const CalibrationVerdict& verdict) {
  nlohmann::json recordings = nlohmann::json::array(), tags = nlohmann::json::array(),
                 groups = nlohmann::json::array(), found = nlohmann::json::array();
  for (const RecordingFacts& recording : facts.recordings) recordings.push_back(json_of(recording));
  for (const TagSummary& tag : summarise_tags(facts)) tags.push_back(json_of(tag));
  for (const std::vector<TagKey>& part : joined_parts(facts.places)) {
    groups.push_back(nlohmann::json::array());
    for (const TagKey& tag : part) groups.back().push_back(to_string(tag));
  }
  for (const RecordingFinding& finding : findings)
    found.push_back(
        {{"about", finding.about}, {"severity", word_of(finding.severity)}, {"text", finding.text}});
  return {{"verdict", word_of(verdict.readiness)},
          {"verdict_text", verdict.text},
          {"families", facts.families},
          {"recordings", recordings},
          {"tags", tags},
          {"groups", groups},
          {"findings", found},
          {"interrupted", facts.is_interrupted}};
}

}  // namespace apriltrack::app
