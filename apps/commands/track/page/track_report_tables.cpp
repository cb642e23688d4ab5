#include "track_report_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "apriltrack/base/degrees.h"
#include "apriltrack/eval/statistics.h"
#include "pages/status_colours.h"

namespace apriltrack::app {
namespace {

std::string share_of(std::size_t count, std::size_t all) {
  return fmt::format("{:.1f} %", 100.0 * static_cast<double>(count) / static_cast<double>(all));
}

const char* meaning_of(TrackStatus status) {
  switch (status) {
    case TrackStatus::kDetected:
      return "the pose rests on a tag that was read in this frame.";
    case TrackStatus::kTracked:
      return "no tag could be read, but the picture's grey levels hold the pose.";
    case TrackStatus::kPredicted:
      return "carried on from the motion before, for at most 0.5 s; nothing in this frame confirms it.";
    case TrackStatus::kLost:
      return "no pose.";
    case TrackStatus::kUnreadable:
      return "the frame could not be decoded, or has not the camera's resolution.";
  }
  return "";
}

std::string range_of_exposures(const std::vector<double>& exposures_s) {
  const auto [low, high] = std::ranges::minmax(exposures_s);
  if (high - low <= 1e-6) return fmt::format("{:.3g} ms", 1e3 * low);
  return fmt::format("{:.3g} to {:.3g} ms, median {:.3g} ms", 1e3 * low, 1e3 * high,
                     1e3 * median(exposures_s));
}

/// A frame's own exposure goes before the camera file's.
std::string exposure(const TrackRun& run) {
  const std::vector<double>& told = run.record.exposures_s();
  const std::optional<ExposureReport>& last = run.record.last_exposure();
  const std::string blur =
      last && last->is_doubted() ? fmt::format("; blur shows {:.2g} times as much", last->factor()) : "";
  if (!told.empty()) return range_of_exposures(told) + " (told by the frames)" + blur;
  if (run.camera.exposure_s)
    return fmt::format("{:.3g} ms (told by the camera file)", 1e3 * *run.camera.exposure_s) + blur;
  return last ? exposure_not_told(*last) : "not told";
}

std::string median_and_worst(const std::optional<ClaimedSigma>& sigma) {
  if (!sigma) return "no pose claims any";
  return fmt::format("{:.2f} mm and {:.3f} degrees; at worst {:.2f} mm and {:.3f} degrees",
                     1e3 * sigma->median_position_m, kDegPerRad * sigma->median_rotation_rad,
                     1e3 * sigma->worst_position_m, kDegPerRad * sigma->worst_rotation_rad);
}

std::string longest_blind(const RunStatistics& figures) {
  if (figures.blind.empty()) return "none: every frame has evidence";
  const BlindStretch& longest = figures.blind.front();
  return fmt::format("{:.3f} s ({} frames), from {:.3f} s to {:.3f} s", longest.duration_s(),
                     longest.frames(), longest.from_s, longest.to_s);
}

std::string latency(const RunStatistics& figures) {
  if (!figures.latency_p50_ms) return "-";
  return fmt::format("{:.1f} ms median, {:.1f} ms in 99 % of the frames; at most {:.1f} ms, at {:.3f} s",
                     *figures.latency_p50_ms, *figures.latency_p99_ms, *figures.latency_max_ms,
                     figures.latency_max_at_s);
}

std::string numbers_of(const BlindStretch& stretch) {
  std::string text;
  const auto add = [&](std::size_t count, const char* word) {
    if (count == 0) return;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, word);
  };
  add(stretch.predicted, "predicted");
  add(stretch.lost, "lost");
  add(stretch.unreadable, "unreadable");
  return text;
}

}  // namespace

const std::string& input_name(const TrackArguments& arguments) {
  return arguments.input.empty() ? arguments.detections : arguments.input;
}

std::string verdict(const TrackRun& run, const RunStatistics& figures) {
  if (!run.record.has_pose()) return "No frame has a pose: " + run.record.why_no_pose(run.map);
  if (figures.blind.empty())
    return fmt::format("All {} frames have a pose that rests on what the frame shows (detected or tracked).",
                       figures.frames);
  std::string text = fmt::format(
      "{} of {} frames ({}) have a pose that rests on what the frame shows (detected or tracked).",
      figures.with_evidence, figures.frames, share_of(figures.with_evidence, figures.frames));
  const BlindStretch& longest = figures.blind.front();
  const std::string stretches = figures.blind.size() == 1
                                    ? std::string("one stretch")
                                    : fmt::format("{} stretches, the longest", figures.blind.size());
  text += fmt::format(" The others lie in {} of {:.3f} s from {:.3f} s on.", stretches, longest.duration_s(),
                      longest.from_s);
  const std::size_t predicted = figures.statuses[index_of_status("predicted")].frames;
  if (predicted > 0)
    text += fmt::format(" {} {} predicted only: do not rely on {}.", predicted,
                        predicted == 1 ? "pose is" : "poses are", predicted == 1 ? "it" : "them");
  return text;
}

std::string describe_tags(const TrackRecord& record, const TagMap& map) {
  std::set<TagKey> never, strange;
  for (const MapTag& tag : map.tags)
    if (!record.frames_by_tag().contains(tag.key)) never.insert(tag.key);
  for (const auto& [key, frames] : record.frames_by_tag())
    if (!map.find(key)) strange.insert(key);
  std::string text = fmt::format("{} of the map's {} tags were detected at least once.",
                                 map.tags.size() - never.size(), map.tags.size());
  if (!never.empty()) text += fmt::format(" Never: {}.", list_of_tags(never));
  if (!strange.empty())
    text += fmt::format(" Detected, but not in the map, and so of no use: {}.", list_of_tags(strange));
  return text;
}

HtmlTable summary_table(const TrackRun& run, const RunStatistics& figures) {
  const auto number = [&](std::size_t count) {
    return fmt::format("{} ({})", count, share_of(count, figures.frames));
  };
  return {{"figure", "value"},
          {{"frames", fmt::format("{} in {:.3f} s", figures.frames, figures.duration_s)},
           {"first pose", figures.first_pose_s ? fmt::format("at {:.3f} s", *figures.first_pose_s) : "none"},
           {"longest stretch without evidence", longest_blind(figures)},
           {"claimed error (sigma), median of all poses", median_and_worst(figures.sigma)},
           {"poses from a single tag", number(figures.from_one_tag)},
           {"poses with a second explanation", number(figures.with_second_pose)},
           {"exposure", exposure(run)},
           {"latency", latency(figures)}},
          fmt::format(
              "Times count from the first frame, {} ns. Sigma is the root mean square length of the "
              "error that the covariance expects. A pose from a single tag has nothing to contradict it, "
              "and needs the right map all the more. A second explanation is another pose that the "
              "frame may show: one flat tag far away may be tilted either way, a blurred path has a reverse.",
              run.record.rows().front().timestamp.ns)};
}

std::string describe_map_share(const TrackRun& run, const RunStatistics& figures) {
  // Of the claim. Tags near each other and seen from afar do ten times their own sigma to a position.
  constexpr double kNotable = 0.05;
  if (run.arguments.method() == "paper" || !figures.sigma) return "";  // its particles know no map's errors
  std::vector<double> tag_sigmas_m;
  for (const MapTag& tag : run.map.tags)
    tag_sigmas_m.push_back(tag.covariance ? std::sqrt(tag.covariance->topLeftCorner<3, 3>().trace()) : 0.0);
  const double of_map_m = median(tag_sigmas_m);
  if (of_map_m < kNotable * figures.sigma->median_position_m || of_map_m == 0.0) return "";
  return fmt::format(
      "The map's own uncertainty is in the claimed errors, and may be most of them: its tags' positions have "
      "a sigma of {:.2f} mm (median), and a camera far from the tags makes more of it. Relative to the tags "
      "in view the poses are better than that. More views that link the tags, in calibration, make it "
      "smaller.",
      1e3 * of_map_m);
}

HtmlTable status_table(const RunStatistics& figures) {
  HtmlTable table{{"status", "frames", "share", "sigma, mm", "worst", "sigma, degrees", "worst"},
                  {},
                  "Sigma: what the poses of the status claim to be off by, median and worst."};
  for (const StatusFigures& status : figures.statuses) {
    std::vector<std::string> row = {std::string(status.status), fmt::format("{}", status.frames),
                                    share_of(status.frames, figures.frames)};
    if (const auto& sigma = status.sigma) {
      row.insert(row.end(), {fmt::format("{:.2f}", 1e3 * sigma->median_position_m),
                             fmt::format("{:.2f}", 1e3 * sigma->worst_position_m),
                             fmt::format("{:.3f}", kDegPerRad * sigma->median_rotation_rad),
                             fmt::format("{:.3f}", kDegPerRad * sigma->worst_rotation_rad)});
    } else {
      row.insert(row.end(), 4, "-");
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::vector<std::string> meanings_of_statuses() {
  std::vector<std::string> meanings;
  for (const TrackStatus status : kTrackStatuses)
    meanings.push_back(fmt::format("{}: {}", to_string(status), meaning_of(status)));
  return meanings;
}

HtmlTable blind_table(const RunStatistics& figures) {
  constexpr std::size_t kShown = 12;
  HtmlTable table{{"from, s", "lasts, s", "frames", "first frame, ns", "why lost, mostly"},
                  {},
                  fmt::format("Stretches without evidence, the longest first ({} of {}): from the last "
                              "evidence before to the first after.",
                              std::min(kShown, figures.blind.size()), figures.blind.size())};
  for (const BlindStretch& stretch : figures.blind) {
    if (table.rows.size() == kShown) break;
    table.rows.push_back({fmt::format("{:.3f}", stretch.from_s), fmt::format("{:.3f}", stretch.duration_s()),
                          numbers_of(stretch), fmt::format("{}", stretch.first_frame.ns),
                          stretch.reason.empty() ? "-" : stretch.reason});
  }
  return table;
}

HtmlTable reasons_table(const TrackRecord& record) {
  constexpr std::size_t kShown = 20;
  std::vector<std::pair<int, std::string>> reasons;
  for (const auto& [reason, frames] : record.lost_reasons()) reasons.emplace_back(frames, reason);
  std::ranges::stable_sort(reasons, std::greater(), &std::pair<int, std::string>::first);
  HtmlTable table{{"why frames are lost", "frames"}, {}, ""};
  int others = 0;
  for (const auto& [frames, reason] : reasons) {
    if (table.rows.size() < kShown) {
      table.rows.push_back({reason, fmt::format("{}", frames)});
    } else {
      others += frames;
    }
  }
  if (others > 0) table.rows.push_back({"other reasons", fmt::format("{}", others)});
  return table;
}

}  // namespace apriltrack::app
