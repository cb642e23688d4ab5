#include "calibration_words.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include "camera_words.h"
#include "print_errors.h"
#include "rejected_stands.h"
#include "time_errors.h"

namespace apriltrack {
namespace {

constexpr double kHighResidual_px = 1.0;
constexpr double kRejectedOfOneTag = 0.25;
constexpr double kManyOfAllRejected = 0.1;
constexpr int kFewRejected = 3;
constexpr double kUsuallyRejected = 0.01;
constexpr double kLogRare = 6.0;  // once in 400

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
  const double all_offered = static_cast<double>(solution.views_offered);
  const double all_rejected = all_offered - static_cast<double>(solution.part.views.size());
  for (const auto& [tag, views] : count_views(observations, solution.part)) {
    const int offered = solution.views_offered_by_tag[static_cast<std::size_t>(tag)];
    const double of_others = (all_rejected - (offered - views)) / std::max(1.0, all_offered - offered);
    if (is_rejected_often(offered, offered - views, of_others))
      names += fmt::format("{}{} ({} of {})", names.empty() ? "" : ", ", to_string(key_of(observations, tag)),
                           offered - views, offered);
  }
  if (!names.empty())
    findings.warnings.push_back(
        "many views were rejected of " + names +
        ": trust their places less; a wrong size, a bend, or a tag that moved may be the cause");
}

bool is_any_left_out(const PartSolution& solution) {
  return !solution.culprits.empty() || std::ranges::any_of(solution.findings, &TagFinding::is_left_out);
}

/// Faults of tags that have a name; and of a culprit whose fault has none.
void report_findings(const Observations& observations, const PartSolution& solution, Findings& findings) {
  std::vector<int> unnamed = solution.culprits;
  for (const TagFinding& finding : solution.findings) {
    findings.warnings.push_back(finding.words);
    if (finding.is_left_out) findings.left_out.push_back(key_of(observations, finding.tag));
    std::erase(unnamed, finding.tag);
  }
  leave_out(observations, unnamed,
            unnamed.size() < 2 ? "its views contradict those of the other tags (a wrong size? moved while "
                                 "filming? an id that hangs in two places?)"
                               : "without any one of them the others agree, and nothing tells which is wrong "
                                 "(a wrong size? moved while filming? an id that hangs in two places?)",
            findings);
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
  std::ranges::move(doubts_of_cameras(observations, solution.cameras), std::back_inserter(findings.warnings));
  const std::string what = words_of_what_stays(observations, solution, options);
  if (!what.empty() && !cameras.reason.empty())
    findings.warnings.push_back(fmt::format("{} stay as the camera file has them: {}", what, cameras.reason));
}

}  // namespace

TagKey key_of(const Observations& observations, int tag) {
  return observations.tags[static_cast<std::size_t>(tag)];
}

std::vector<TagKey> keys_of(const Observations& observations, const std::vector<int>& tags) {
  std::vector<TagKey> keys;
  for (const int tag : tags) keys.push_back(key_of(observations, tag));
  return keys;
}

void leave_out(const Observations& observations, const std::vector<int>& tags, const std::string& reason,
               Findings& findings) {
  if (tags.empty()) return;
  const std::vector<TagKey> keys = keys_of(observations, tags);
  findings.warnings.push_back(fmt::format("left out: {}: {}", list_tags(keys), reason));
  findings.left_out.insert(findings.left_out.end(), keys.begin(), keys.end());
}

void report_quality(const Observations& observations, const PartSolution& solution,
                    const CalibrationOptions& options, Findings& findings) {
  if (solution.covariances.empty())
    findings.warnings.push_back(
        fmt::format("no covariances, and no check that the views determine every pose: the map has {} tags, "
                    "and the matrix to invert grows with the square of their number (at most {} tags)",
                    solution.part.tags.size(), options.max_tags_with_covariance));
  for (std::size_t i = solution.known_time_errors.size(); i < solution.time_errors.size(); ++i)
    findings.warnings.push_back(words_of(solution.time_errors[i]));
  report_findings(observations, solution, findings);
  const bool is_first = !solution.are_cameras_given;  // what is true of the cameras is said once
  if (is_first) report_cameras(observations, solution, options, findings);
  std::ranges::move(words_of_prints(solution.print_batches, is_first ? solution.print_aspect : std::nullopt),
                    std::back_inserter(findings.warnings));
  leave_out(
      observations, solution.undecided,
      solution.undecided.size() < 2
          ? "its views agree with two poses about equally well: film it from further aside, and nearer"
          : "the views of each agree with two poses about equally well: film them from further aside, and "
            "nearer",
      findings);
  leave_out(
      observations, solution.contradicted,
      solution.contradicted.size() < 2
          ? "most of its views contradict those of the other tags: a wrong size, a bend, or a tag that "
            "moved may be the cause"
          : "most views of each contradict those of the other tags: wrong sizes, bends, or tags that moved "
            "may be the cause",
      findings);
  leave_out(observations, solution.lost_tags,
            is_any_left_out(solution) ? "tied to the others by such a tag, or by frames that contradict them"
                                      : "tied to the others by frames that contradict them",
            findings);
  warn_of_rejected_tags(observations, solution, findings);
  for (const std::string& words : solution.lost_links) findings.warnings.push_back(words);
  for (std::string& words : words_of_stands(observations, solution.part, solution.rejected_at_rest))
    findings.warnings.push_back(std::move(words));
  const double rejected =
      1.0 - static_cast<double>(solution.part.views.size()) / static_cast<double>(solution.views_offered);
  if (rejected > kManyOfAllRejected)
    findings.warnings.push_back(
        fmt::format("{:.0f} % of the observations were rejected as outliers: a tag of wrong size, a "
                    "moved tag or strong blur may be the cause",
                    100.0 * rejected));
  if (solution.total_rms_px > kHighResidual_px)
    findings.warnings.push_back(
        fmt::format("the residuals are high ({:.2f} px; 0.1 to 0.4 is usual): check the camera file "
                    "and the tag sizes",
                    solution.total_rms_px));
}

void report_other_parts(const Observations& observations, const std::vector<Part>& parts,
                        Findings& findings) {
  for (std::size_t i = 1; i < parts.size(); ++i)
    findings.warnings.push_back(fmt::format(
        "a part of its own, not in the map: {}: no frame shows one of these together with a tag of the map",
        list_tags(keys_of(observations, parts[i].tags))));
}

void report_resting_frames(const RestingFrames& resting, std::size_t moments_before, Findings& findings,
                           const LogSink& log) {
  const std::string words = fmt::format(
      "{} of {} frames show what another shows, from the same place, and count with it: {} {} at rest",
      resting.merged, moments_before, resting.places, resting.places == 1 ? "place" : "places");
  if (2 * static_cast<std::size_t>(resting.merged) > moments_before)
    findings.warnings.push_back(
        words + ". What errs in one of them errs in all: film from more places for a better map");
  else
    log(LogLevel::kInfo, words);
}

void warn_of_edges(const std::vector<CameraCorrection>& corrections, const CalibrationOptions& options,
                   Findings& findings) {
  constexpr double kUsual = 2.5;  // of the expected sizes: one camera in 80 is beyond
  for (const CameraCorrection& one : corrections) {
    if (!one.is_of_edges() || !(std::abs(one.value) > kUsual * options.edge_offset_sigma_px)) continue;
    findings.warnings.push_back(
        fmt::format("{}: edges are found {:.2f} px aside of where the detector has them (edge offset, sigma "
                    "{:.2f}), more than is usual (--edge-offset-sigma {:.3g}): if that is wrong, so is the "
                    "scale of the map. Film from nearer and from further aside, give a measured distance "
                    "(--constraints), or refuse it (--edge-offset-sigma 0)",
                    one.camera, one.value, one.sigma, options.edge_offset_sigma_px));
  }
}

}  // namespace apriltrack
