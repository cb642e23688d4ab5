#include "messages/link_messages.h"

#include <fmt/format.h>

#include "messages/tag_messages.h"

namespace apriltrack {

CalibrationFinding reported(const Observations& observations, const LostLink& link) {
  const std::vector<TagKey> ends = keys_of(observations, {link.tag_a, link.tag_b});
  const std::vector<TagKey> joints = keys_of(observations, link.joints);
  const bool is_one = link.num_frames == 1;
  CalibrationFinding finding;
  finding.kind = CalibrationFinding::Kind::kInconsistentLink;
  finding.tags = ends;
  for (const TagKey& joint : joints) finding.alternatives.push_back({joint});
  finding.message = fmt::format(
      "{0} and {1} are seen together in {2} {3}, which the map does not fit; it joins them by way of {4} "
      "alone. If {5} right, one of them hangs twice or was moved, and the map is folded there. Film {0} and "
      "{1} together again",
      to_string(ends[0]), to_string(ends[1]), link.num_frames, is_one ? "frame only" : "frames only",
      list_tags(joints), is_one ? "that is" : "these are");
  return finding;
}

CalibrationFinding reported(const Observations& observations, const SplitLink& link) {
  const std::vector<TagKey> joint = keys_of(observations, link.joint);
  const std::string board = list_tags(joint);
  const bool is_one = joint.size() == 1;
  CalibrationFinding finding;
  finding.kind = CalibrationFinding::Kind::kInconsistentLink;
  finding.tags = keys_of(observations, {link.tag, link.beside});
  finding.value = link.change.translation().norm();
  finding.unit = "m";
  finding.alternatives = {joint};
  finding.message = fmt::format(
      "{0} and {1} are seen together in {2} frames, of which {3} {0} {4} from where the map has it. {5} "
      "alone {6} other tags to the map: if {7} twice (a duplicate) or {8} moved, the map may be folded "
      "there. Look for a second {5}, and film {9} together with more of the others",
      to_string(finding.tags[0]), to_string(finding.tags[1]), link.num_frames,
      link.num_frames_elsewhere == 1 ? "1 shows" : fmt::format("{} show", link.num_frames_elsewhere),
      shift_and_turn(link.change), board, is_one ? "joins" : "join", is_one ? "it hangs" : "they hang",
      is_one ? "was" : "were", is_one ? "it" : "them");
  return finding;
}

CalibrationFinding reported(const Observations& observations, const RejectedStand& stand) {
  CalibrationFinding finding;
  finding.kind = CalibrationFinding::Kind::kDisplacedAtRest;
  finding.tags = keys_of(observations, stand.tags);
  finding.value = stand.num_frames;
  finding.unit = "1";
  finding.timestamp = stand.first;
  const std::string where =
      fmt::format("in {} frames of one place, about {:.2f} s after the first frame", stand.num_frames,
                  seconds_between(observations.frames.front(), stand.first));
  finding.message =
      finding.tags.size() == 1
          ? fmt::format(
                "{} is not where the map has it {}: it was moved for that long, or something lay on its "
                "edges; those frames do not count for it",
                to_string(finding.tags.front()), where)
          : fmt::format(
                "{} do not lie to each other as the map has them {}: one of them was moved for that "
                "long, or something lay on its edges; those frames do not count",
                list_tags(finding.tags), where);
  return finding;
}

}  // namespace apriltrack
