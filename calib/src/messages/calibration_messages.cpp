#include "messages/calibration_messages.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include "apriltrack/base/log.h"
#include "apriltrack/calib/calibration_options.h"
#include "apriltrack/calib/systematic_errors.h"
#include "apriltrack/detect/picture_size.h"
#include "messages/camera_messages.h"
#include "messages/link_messages.h"
#include "messages/systematic_messages.h"
#include "messages/tag_messages.h"
#include "numerics/words.h"

namespace apriltrack {
namespace {

using FindingKind = CalibrationFinding::Kind;

constexpr double kHighResidual_px = 1.0;
constexpr double kRejectedOfOneTag = 0.25;
constexpr double kManyOfAllRejected = 0.1;
constexpr int kFewRejected = 3;
constexpr double kUsuallyRejected = 0.01;
constexpr double kLogRare = 6.0;  // once in 400
constexpr double kLeastUsualSize_m = 0.005, kMostUsualSize_m = 3.0;

/// Many, or more than others by more than chance: a few views that agree on another place may be right.
bool is_rejected_often(int offered, int rejected, double share_of_others) {
  const double share = static_cast<double>(rejected) / std::max(1, offered);
  return share > kRejectedOfOneTag ||
         (rejected >= kFewRejected &&
          offered * divergence(share, std::max(kUsuallyRejected, share_of_others)) > kLogRare);
}

void warn_of_rejected_tags(const Observations& observations, const PartSolution& solution,
                           Findings& findings) {
  std::string names;
  CalibrationFinding finding;
  double largest_share = 0.0;
  const double all_offered = static_cast<double>(solution.views_offered);
  const double all_rejected = all_offered - static_cast<double>(solution.part.views.size());
  for (const auto& [tag, views] : count_views(observations, solution.part)) {
    const int offered = solution.views_offered_by_tag[static_cast<std::size_t>(tag)];
    const double of_others = (all_rejected - (offered - views)) / std::max(1.0, all_offered - offered);
    if (!is_rejected_often(offered, offered - views, of_others)) continue;
    finding.tags.push_back(key_of(observations, tag));
    largest_share = std::max(largest_share, static_cast<double>(offered - views) / std::max(1, offered));
    names += fmt::format("{}{} ({} of {})", names.empty() ? "" : ", ", to_string(finding.tags.back()),
                         offered - views, offered);
  }
  if (names.empty()) return;
  finding.kind = FindingKind::kOftenRejected;
  finding.value = largest_share;
  finding.unit = "1";
  finding.message = "many views were rejected of " + names +
                    ": trust their places less; a wrong size, a bend, or a tag that moved may be the cause";
  findings.push_back(std::move(finding));
}

bool is_any_left_out(const PartSolution& solution) {
  return std::ranges::any_of(solution.findings, &TagFinding::is_left_out);
}

/// "the intrinsics", or "the intrinsics of cam1": of the cameras that see the part, those that were to be
/// refined, and were not.
std::string words_of_what_stays(const Observations& observations, const PartSolution& solution,
                                const CalibrationOptions& options) {
  using IsOf = bool (CameraParameter::*)() const;
  const std::vector<int> cameras = cameras_of(observations, solution.part);
  const CameraParameters refined = parameters_of(solution.cameras.refined);
  const std::string& first_name = observations.cameras[static_cast<std::size_t>(cameras.front())].name;
  const auto stays = [&](const std::string& what, IsOf is_of) -> std::string {
    std::vector<std::string> names;
    for (const int camera : cameras) {
      const auto is_one = [&](const CameraParameter& one) { return one.camera == camera && (one.*is_of)(); };
      if (std::ranges::none_of(refined, is_one))
        names.push_back(observations.cameras[static_cast<std::size_t>(camera)].name);
    }
    if (is_of == &CameraParameter::is_of_place && cameras.size() > 1)
      std::erase(names, first_name);  // the others' places are told from it
    if (names.empty() || std::ranges::none_of(refined, is_of)) return names.empty() ? "" : what;
    return fmt::format("{} of {}", what, fmt::join(names, ", "));
  };
  std::vector<std::string> words;
  if (options.intrinsics == Intrinsics::kRefine)
    words.push_back(stays("the intrinsics", &CameraParameter::is_of_lens));
  if (options.refine_extrinsics)
    words.push_back(stays("the places of the cameras", &CameraParameter::is_of_place));
  std::erase(words, "");
  return fmt::format("{}", fmt::join(words, " and "));
}

/// What was asked for in vain, and what was not to be taken.
void report_cameras(const Observations& observations, const PartSolution& solution,
                    const CalibrationOptions& options, Findings& findings) {
  const CameraRefinement& cameras = solution.cameras.refined;
  std::ranges::move(doubts_of_cameras(observations, solution.cameras), std::back_inserter(findings));
  const std::string what = words_of_what_stays(observations, solution, options);
  if (!what.empty() && !cameras.reason.empty())
    findings.push_back(
        to_finding(FindingKind::kCameraNotRefined,
                   fmt::format("{} stay as the camera file has them: {}", what, cameras.reason)));
}

}  // namespace

CalibrationFinding to_finding(FindingKind kind, std::string message) {
  CalibrationFinding finding;
  finding.kind = kind;
  finding.message = std::move(message);
  return finding;
}

void leave_out(FindingKind kind, const Observations& observations, const std::vector<int>& tags,
               const std::string& reason, Findings& findings) {
  if (tags.empty()) return;
  CalibrationFinding finding;
  finding.kind = kind;
  finding.tags = keys_of(observations, tags);
  finding.is_left_out = true;
  finding.message = fmt::format("left out: {}: {}", list_tags(finding.tags), reason);
  findings.push_back(std::move(finding));
}

std::vector<TagKey> tags_left_out(const Findings& findings) {
  std::set<TagKey> tags;
  for (const CalibrationFinding& finding : findings)
    if (finding.is_left_out) tags.insert(finding.tags.begin(), finding.tags.end());
  return {tags.begin(), tags.end()};
}

void report_picture_sizes(std::span<const FrameDetections> frames, const CameraRig& rig, Findings& findings) {
  for (std::string& message : check_picture_sizes(frames, rig))
    findings.push_back(to_finding(FindingKind::kPictureSize, std::move(message)));
}

void report_unused(const UnusedDetections& unused, Findings& findings) {
  if (unused.unusable > 0) {
    findings.push_back(
        to_finding(FindingKind::kUnusableCorners,
                   fmt::format("{} of {} detections are not used: corners not finite, not a tag's "
                               "front, too small, or outside what the lens model covers",
                               unused.unusable, unused.detections)));
    findings.back().value = static_cast<double>(unused.unusable);
    findings.back().unit = "1";
  }
  for (const RepeatedTag& tag : unused.repeated) {
    const bool is_left_out = tag.is_many_tags();
    findings.push_back(to_finding(
        FindingKind::kDuplicateId,
        is_left_out ? description_of(tag) + "; it is left out"
                    : fmt::format("{} is seen at two places at once in {} of {} frames: not used there",
                                  to_string(tag.tag), tag.frames_with_copies, tag.frames)));
    findings.back().tags = {tag.tag};
    findings.back().is_left_out = is_left_out;
  }
}

std::vector<std::string> doubts_of_map(const Observations& observations, const PartSolution& solution) {
  Findings doubts;
  for (const LostLink& link : solution.lost_links) doubts.push_back(reported(observations, link));
  for (const SplitLink& link : solution.split_links) doubts.push_back(reported(observations, link));
  for (const TagFinding& finding : solution.findings)
    if (finding.may_fold_map()) doubts.push_back(reported(observations, finding));
  std::ranges::move(doubts_of_cameras(observations, solution.cameras), std::back_inserter(doubts));
  if (solution.print_batches) doubts.push_back(reported(*solution.print_batches));
  if (solution.print_aspect) doubts.push_back(reported_print_aspect(*solution.print_aspect));
  for (const TimeError& error : solution.time_errors) doubts.push_back(reported(error));
  return messages_of(doubts);
}

void report_quality(const Observations& observations, const PartSolution& solution,
                    const CalibrationOptions& options, Findings& findings) {
  if (solution.covariances.empty()) {
    findings.push_back(to_finding(
        FindingKind::kNoCovariances,
        fmt::format("no covariances, and no check that the views determine every pose: the map has {} tags, "
                    "and the matrix to invert grows with the square of their number (at most {} tags)",
                    solution.part.tags.size(), options.max_tags_with_covariance)));
    findings.back().value = static_cast<double>(solution.part.tags.size());
    findings.back().unit = "1";
  }
  for (std::size_t i = solution.known_time_errors.size(); i < solution.time_errors.size(); ++i)
    findings.push_back(reported(solution.time_errors[i]));
  for (const TagFinding& finding : solution.findings) findings.push_back(reported(observations, finding));
  const bool is_first = !solution.are_cameras_given;  // what is true of the cameras is said once
  if (is_first) report_cameras(observations, solution, options, findings);
  if (solution.print_batches) findings.push_back(reported(*solution.print_batches));
  if (is_first && solution.print_aspect) findings.push_back(reported_print_aspect(*solution.print_aspect));
  leave_out(
      FindingKind::kAmbiguousPose, observations, solution.undecided,
      solution.undecided.size() < 2
          ? "its views agree with two poses about equally well: film it from further aside, and nearer"
          : "the views of each agree with two poses about equally well: film them from further aside, and "
            "nearer",
      findings);
  leave_out(
      FindingKind::kMostlyRejected, observations, solution.contradicted,
      solution.contradicted.size() < 2
          ? "most of its views contradict those of the other tags: a wrong size, a bend, or a tag that "
            "moved may be the cause"
          : "most views of each contradict those of the other tags: wrong sizes, bends, or tags that moved "
            "may be the cause",
      findings);
  leave_out(FindingKind::kLostWithOthers, observations, solution.lost_tags,
            is_any_left_out(solution) ? "tied to the others by such a tag, or by frames that contradict them"
                                      : "tied to the others by frames that contradict them",
            findings);
  warn_of_rejected_tags(observations, solution, findings);
  for (const LostLink& link : solution.lost_links) findings.push_back(reported(observations, link));
  for (const SplitLink& link : solution.split_links) findings.push_back(reported(observations, link));
  for (const RejectedStand& stand : solution.rejected_stands)
    findings.push_back(reported(observations, stand));
  const double rejected =
      1.0 - static_cast<double>(solution.part.views.size()) / static_cast<double>(solution.views_offered);
  if (rejected > kManyOfAllRejected) {
    findings.push_back(
        to_finding(FindingKind::kManyRejected,
                   fmt::format("{:.0f} % of the observations were rejected as outliers: a tag of wrong "
                               "size, a moved tag or strong blur may be the cause",
                               100.0 * rejected)));
    findings.back().value = rejected;
    findings.back().unit = "1";
  }
  if (solution.total_rms_px > kHighResidual_px) {
    findings.push_back(
        to_finding(FindingKind::kHighResiduals,
                   fmt::format("the residuals are high ({:.2f} px; 0.1 to 0.4 is usual): check the "
                               "camera file and the tag sizes",
                               solution.total_rms_px)));
    findings.back().value = solution.total_rms_px;
    findings.back().unit = "px";
  }
}

void report_other_parts(const Observations& observations, const std::vector<Part>& parts,
                        Findings& findings) {
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const std::vector<TagKey> tags = keys_of(observations, parts[i].tags);
    findings.push_back(to_finding(FindingKind::kSeparateComponent,
                                  fmt::format("a part of its own, not in the map: {}: no frame "
                                              "shows one of these together with a tag of the map",
                                              list_tags(tags))));
    findings.back().tags = tags;
  }
}

void report_resting_frames(const RestingFrames& resting, std::size_t moments_before, Findings& findings,
                           const LogSink& log) {
  const std::string words = fmt::format(
      "{} of {} frames show what another shows, from the same place, and count with it: {} {} at rest",
      resting.merged, moments_before, resting.places, resting.places == 1 ? "place" : "places");
  if (2 * static_cast<std::size_t>(resting.merged) <= moments_before) {
    log(LogLevel::kInfo, words);
    return;
  }
  findings.push_back(
      to_finding(FindingKind::kStationaryFrames,
                 words + ". What errs in one of them errs in all: film from more places for a better map"));
  findings.back().value = resting.merged;
  findings.back().unit = "1";
}

void report_repeated_frames(int num_frames, Findings& findings) {
  if (num_frames == 0) return;
  const bool is_one = num_frames == 1;
  findings.push_back(to_finding(
      FindingKind::kRepeatedFrames,
      fmt::format(
          "{} exactly the corners of an earlier one, and {} not counted: a film that stands still, or "
          "frames that were copied, say no more than one picture",
          is_one ? "1 frame shows" : fmt::format("{} frames show", num_frames), is_one ? "is" : "are")));
  findings.back().value = num_frames;
  findings.back().unit = "1";
}

void report_unusual_sizes(const Observations& observations, const std::vector<Part>& parts,
                          Findings& findings) {
  std::vector<TagKey> unusual;
  double size_m = 0.0;
  for (const Part& part : parts) {
    for (const int tag : part.tags) {
      const double of_tag_m = observations.sizes_m[static_cast<std::size_t>(tag)];
      if (of_tag_m >= kLeastUsualSize_m && of_tag_m <= kMostUsualSize_m) continue;
      unusual.push_back(key_of(observations, tag));
      size_m = of_tag_m;
    }
  }
  if (unusual.empty()) return;
  std::sort(unusual.begin(), unusual.end());
  findings.push_back(to_finding(
      FindingKind::kUnusualSize,
      fmt::format("{} given a size of {:.3g} m: sizes are in metres, of the square whose corners are "
                  "detected. All distances of the map are in proportion to them",
                  unusual.size() == 1 ? list_tags(unusual) + " is" : list_tags(unusual) + " are", size_m)));
  findings.back().tags = unusual;
  findings.back().value = size_m;
  findings.back().unit = "m";
}

void report_constraints(const ConstraintNotes& notes, Findings& findings) {
  for (const std::string& message : notes.not_measured)
    findings.push_back(to_finding(FindingKind::kFrameNotMeasured, message));
  for (const std::string& message : notes.unused)
    findings.push_back(to_finding(FindingKind::kUnusedConstraint, message));
  for (const std::string& message : notes.in_doubt)
    findings.push_back(to_finding(FindingKind::kConstraintInDoubt, message));
}

void report_unrefined(const std::vector<TagKey>& tags, Findings& findings) {
  if (tags.empty()) return;
  std::vector<std::string> names;
  for (const TagKey& tag : tags) names.push_back(to_string(tag));
  const bool is_one = tags.size() == 1;
  findings.push_back(to_finding(
      FindingKind::kNotRefined,
      fmt::format(
          "{} as the corners have {}, for too few pictures can be used that join {} to the others (too "
          "bright, covered, blurred, or another tag's)",
          is_one ? names.front() + " stays" : join_first(names, ", ", 10) + " stay", is_one ? "it" : "them",
          is_one ? "it" : "them")));
  findings.back().tags = tags;
}

}  // namespace apriltrack
