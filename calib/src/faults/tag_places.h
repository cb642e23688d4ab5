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
  double fee() const { return cost - fit.cost - second.cost; }
};

/// Of a change of a tag's pose: how far it must shift to be told; 0 where it turns enough.
double least_shift_m(const Pose& change, double size_m);

/// How far apart two tags that hang at a time must be, one turned and shifted so against the other.
double least_between_tags_m(const Pose& change, double size_m);

/// Where views that are so and others are told apart best by time: the first after the change.
std::size_t moment_of_change(const std::vector<bool>& is_so);

/// First at the one, then at the other; nullopt where the views tell no two places apart. probes: in the
/// order of time. one: the best single place.
std::optional<TwoPlaces> moved_once(const std::vector<ProbeView>& probes, const TagFit& one, double size_m);

/// Of the place with fewer views: whether one tag there explains them, in frames that are beyond doubt, and
/// nothing at the other place does. No lens does that.
bool is_beyond_doubt(const TwoPlaces& two, const std::vector<ProbeView>& probes);
/// Views that the place does not explain at all.
std::size_t count_elsewhere(const TagFit& one, const std::vector<ProbeView>& probes);

/// Whether the tag leaves one place for the other, and never comes back.
bool is_one_change(const std::vector<bool>& is_at_second);
/// So that `fit` is the place of the first view.
void put_first_view_first(TwoPlaces& two);

/// When and how far, where the tag changed its place once. times: of the views, in order.
PlaceChange change_at_a_moment(const TwoPlaces& two, const std::vector<Timestamp>& times);
/// Seen at the two places by turns.
PlaceChange change_by_turns(const TwoPlaces& two);

/// By turns: two tags of one id; or one that moved, where it is one change after all. `fit` is the place seen
/// first. one: the best single place.
std::optional<TwoPlaces> two_places(const std::vector<ProbeView>& probes, const TagFit& one, double size_m);

/// Many views that no one place explains, though each by itself is a tag's.
bool is_loose(const std::vector<ProbeView>& probes, const TagFit& one);

}  // namespace apriltrack
