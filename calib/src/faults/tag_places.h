#pragma once

#include <optional>
#include <vector>

#include "faults/tag_fit.h"

namespace apriltrack {

/// From one place of a tag to the other; farther, and it may as well be two tags. Two that are nearer would
/// have been seen at once.
inline constexpr double kOneObject_m = 1.0;

/// A tag that is at one of two places, view by view.
struct TwoPlaces {
  double cost;  ///< Half the robust sum of squares, with a fee for what it assumes.
  TagFit fit, second;
  std::vector<bool> is_at_second;  ///< By view.

  Pose change() const { return fit.T_map_tag.inverse() * second.T_map_tag; }
};

/// Of a change of a tag's pose: how far it must shift to be told; 0 where it turns enough.
double least_shift_m(const Pose& change, double size_m);

/// First at the one, then at the other; nullopt where the views tell no two places apart. probes: in the
/// order of time. one: the best single place.
std::optional<TwoPlaces> moved_once(const std::vector<ProbeView>& probes, const TagFit& one, double size_m);

/// Whether the tag leaves one place for the other, and never comes back.
bool is_one_change(const std::vector<bool>& is_at_second);
/// When and how far, where the tag changed its place once. times: of the views, in order.
PlaceChange change_at_a_moment(const TwoPlaces& two, const std::vector<Timestamp>& times);
/// Seen at the two places by turns.
PlaceChange change_by_turns(const TwoPlaces& two);

/// By turns: two tags of one id; or one that moved, where it is one change after all. `fit` is the place seen
/// first. one: the best single place.
std::optional<TwoPlaces> two_places(const std::vector<ProbeView>& probes, const TagFit& one, double size_m);

}  // namespace apriltrack
