#include "track_drawings.h"

namespace apriltrack::app {

TagFate fate_of(const TrackRecord& record, const TagKey& tag) {
  if (record.strays().contains(tag)) return TagFate::kSuspect;
  if (record.seen_tags().contains(tag) || record.frames_by_tag().contains(tag)) return TagFate::kSeen;
  return record.never_seen_tags().contains(tag) ? TagFate::kNeverSeen : TagFate::kNeverInView;
}

Trajectory truth_to_draw(const std::optional<TruthScore>& score) {
  return score && score->is_map_the_recordings ? score->truth : Trajectory{};
}

}  // namespace apriltrack::app
