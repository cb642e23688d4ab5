#include "doctor_findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <iterator>

namespace apriltrack::app {

std::vector<Finding> find_all(const Facts& facts) {
  std::vector<Finding> all = find_in_families(facts);
  const std::vector<TagSummary> tags = summarise_tags(facts);
  std::ranges::move(find_in_tags(tags, joined_parts(facts.places)), std::back_inserter(all));
  std::ranges::move(find_in_places(facts), std::back_inserter(all));
  std::ranges::move(find_in_sizes(facts), std::back_inserter(all));
  for (const RecordingFacts& recording : facts.recordings) {
    using Find = std::function<std::vector<Finding>(const RecordingFacts&)>;
    const Find find_odd = [&](const RecordingFacts& one) {
      return find_in_odd_pictures(one, facts.families);
    };
    for (const Find& find : std::initializer_list<Find>{find_odd, find_in_camera, find_in_response,
                                                        find_in_lens, find_in_images, find_in_blur}) {
      for (Finding& finding : find(recording)) {
        if (facts.recordings.size() > 1) finding.text = recording.input + ": " + finding.text;
        all.push_back(std::move(finding));
      }
    }
  }
  // Of two sizes said to be one camera's, one cannot but differ from the camera file's.
  if (std::ranges::find(all, "camera_sizes", &Finding::about) != all.end())
    std::erase_if(all, [](const Finding& finding) { return finding.about == "camera_resolution"; });
  // Pictures that show tags the wrong way round have no need of sharper ones.
  const bool has_odd_pictures = std::ranges::any_of(
      facts.recordings, [](const RecordingFacts& one) { return one.odd_pictures.has_value(); });
  if (has_odd_pictures) std::erase_if(all, [](const Finding& finding) { return finding.about == "no_tags"; });
  std::ranges::stable_sort(all, {}, &Finding::severity);
  return all;
}

Verdict verdict_of(std::span<const Finding> findings, bool has_tags) {
  const auto is = [](Severity severity) {
    return [severity](const Finding& finding) { return finding.severity == severity; };
  };
  const auto stops = std::ranges::find_if(findings, is(Severity::kStops));
  if (stops != findings.end()) {
    const bool has_twins = std::ranges::find(findings, "same_id_twice", &Finding::about) != findings.end();
    const bool can_be_tracked = has_tags && !has_twins && stops->about == "none_together";
    return {Readiness::kNotReady,
            fmt::format("will not calibrate: {}{}", stops->text,
                        can_be_tracked ? "; with a map of these tags it can be tracked" : "")};
  }
  const auto warnings = std::ranges::count_if(findings, is(Severity::kWarning));
  if (warnings == 0) return {Readiness::kReady, "ready to calibrate"};
  return {Readiness::kReadyWithWarnings,
          fmt::format("will calibrate, but see the {} warning{} above", warnings, warnings == 1 ? "" : "s")};
}

}  // namespace apriltrack::app
