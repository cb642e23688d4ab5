#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "apriltrack/base/timestamp.h"
#include "apriltrack/geometry/pose.h"

namespace apriltrack {

/// How a tag differs from the flat square of the stated size. A sigma is 0 where the number was not
/// estimated.
struct ShapeError {
  double size_m = 0.0;  ///< As stated.
  double log_scale = 0.0, scale_sigma = 0.0;
  double aspect = 0.0, aspect_sigma = 0.0;  ///< Width over height is 1 + aspect.
  double twist = 0.0, twist_sigma = 0.0;    ///< Corners before and behind one plane, as a share of the size.
  bool is_aspect_clear = false, is_twist_clear = false;
  bool is_clear_together = false;  ///< By the three numbers together, not by the one that is clear.
};

/// A tag that was seen at two places.
struct PlaceChange {
  Pose T_first_second;
  bool is_one_after_other = false;  ///< Else by turns.
  Timestamp last_at_first, first_at_second;
};

/// What is wrong with a tag.
struct TagFinding {
  enum class Kind { kSize, kMoved, kTwoPlaces, kNotFlat, kLoose };
  /// Whether another tag may be at fault instead.
  enum class Blame {
    kThisTag,
    kThisOrAnother,
    kThisOrOthersInMap,     ///< One of `others`, which stay in the map: it may be folded there.
    kThisOrOthersNoMap,     ///< One of `others`, and there is no map.
    kJoinsPlacesOfAnother,  ///< With the board `others.front()` it alone joins the two places of
                            ///< `joined_tag`.
  };
  int tag = 0;
  Kind kind = Kind::kSize;
  /// Two places as far apart as tags hang that are there at a time, in whatever order they were seen.
  bool may_be_copies = false;
  std::optional<ShapeError> shape = std::nullopt;    ///< Of kSize and kNotFlat.
  std::optional<PlaceChange> places = std::nullopt;  ///< Of kMoved and kTwoPlaces, unless it joins another's.
  bool is_left_out = false;
  Blame blame = Blame::kThisTag;
  std::vector<std::vector<int>> others = {};  ///< Tags, or boards of them, sorted.
  int joined_tag = -1;
  /// What the views cost, in units of what they would if they erred as expected: with one place and the
  /// stated shape, and with what was found.
  double misfit_before = 0.0, misfit_after = 0.0;
  std::size_t num_views = 0;  ///< That this rests on.
  /// Views of the tag at its one place and at its other, as far as they were looked at; empty where there are
  /// not two.
  std::array<std::vector<std::size_t>, 2> views_by_place = {};
  double explained = 0.0;  ///< Half the squares, of all views, less a fee for the unknowns; if known.

  bool is_in_doubt() const { return blame != Blame::kThisTag; }
  bool may_fold_map() const { return blame == Blame::kThisOrOthersInMap; }
  /// Of a kSize: the logarithm of the size that it has, over the stated one.
  double log_scale() const { return kind == Kind::kSize && shape ? shape->log_scale : 0.0; }
  /// True if the remaining misfit is near 1, or under 10 % (15 % for a size) of the initial one. Always true
  /// of kLoose: no place explains it.
  bool is_complete() const {
    const double most_left = kind == Kind::kSize ? 0.15 : 0.1;
    return kind == Kind::kLoose || misfit_after < 1.6 ||
           (kind != Kind::kNotFlat && misfit_after < most_left * misfit_before);
  }
  double gain() const { return (misfit_before - misfit_after) * static_cast<double>(num_views); }
};

}  // namespace apriltrack
