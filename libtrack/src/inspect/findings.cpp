#include "apriltrack/inspect/findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <iterator>

#include "checks.h"

namespace apriltrack {

std::vector<RecordingFinding> inspection_findings(const InspectionFacts& facts) {
  std::vector<RecordingFinding> all = check_families(facts);
  const std::vector<TagSummary> tags = summarise_tags(facts);
  std::ranges::move(check_tags(tags, joined_parts(facts.places)), std::back_inserter(all));
  std::ranges::move(check_viewpoints(facts), std::back_inserter(all));
  std::ranges::move(check_sizes(facts), std::back_inserter(all));
  for (const RecordingFacts& recording : facts.recordings) {
    using Find = std::function<std::vector<RecordingFinding>(const RecordingFacts&)>;
    const Find find_odd = [&](const RecordingFacts& one) { return check_odd_pictures(one, facts.families); };
    for (const Find& find : std::initializer_list<Find>{find_odd, check_camera, check_response, check_lens,
                                                        check_images, check_blur}) {
      for (RecordingFinding& finding : find(recording)) {
        if (facts.recordings.size() > 1) finding.text = recording.input + ": " + finding.text;
        all.push_back(std::move(finding));
      }
    }
  }
  // Of two sizes said to be one camera's, one cannot but differ from the camera file's.
  if (std::ranges::find(all, "camera_sizes", &RecordingFinding::about) != all.end())
    std::erase_if(all, [](const RecordingFinding& finding) { return finding.about == "camera_resolution"; });
  // Pictures that show tags the wrong way round have no need of sharper ones.
  const bool has_odd_pictures = std::ranges::any_of(
      facts.recordings, [](const RecordingFacts& one) { return one.odd_pictures.has_value(); });
  if (has_odd_pictures)
    std::erase_if(all, [](const RecordingFinding& finding) { return finding.about == "no_tags"; });
  std::ranges::stable_sort(all, {}, &RecordingFinding::severity);
  return all;
}

CalibrationVerdict verdict_of(std::span<const RecordingFinding> findings, bool has_tags) {
  const auto is = [](FindingSeverity severity) {
    return [severity](const RecordingFinding& finding) { return finding.severity == severity; };
  };
  const auto stops = std::ranges::find_if(findings, is(FindingSeverity::kStops));
  if (stops != findings.end()) {
    const bool has_twins =
        std::ranges::find(findings, "same_id_twice", &RecordingFinding::about) != findings.end();
    const bool can_be_tracked = has_tags && !has_twins && stops->about == "none_together";
    return {CalibrationReadiness::kNotReady,
            fmt::format("will not calibrate: {}{}", stops->text,
                        can_be_tracked ? "; with a map of these tags it can be tracked" : "")};
  }
  const auto warnings = std::ranges::count_if(findings, is(FindingSeverity::kWarning));
  if (warnings == 0) return {CalibrationReadiness::kReady, "ready to calibrate"};
  return {CalibrationReadiness::kReadyWithWarnings,
          fmt::format("will calibrate, but see the {} warning{} above", warnings, warnings == 1 ? "" : "s")};
}

}  // namespace apriltrack
