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
  std::optional<ShapeError> shape = std::nullopt;    ///< Of kSize and kNotFlat.
  std::optional<PlaceChange> places = std::nullopt;  ///< Of kMoved and kTwoPlaces, unless it joins another's.
  bool is_left_out = false;
  Blame blame = Blame::kThisTag;
  std::vector<std::vector<int>> others = {};  ///< Tags, or boards of them, sorted.
  int joined_tag = -1;
  /// Views of the tag at its one place and at its other, as far as they were looked at; empty where there are
  /// not two.
  std::array<std::vector<std::size_t>, 2> views_by_place = {};

  std::optional<double> log_odds = std::nullopt;  ///< Of this fault against none, where it was scored; nats.

  bool is_in_doubt() const { return blame != Blame::kThisTag; }
  bool may_fold_map() const { return blame == Blame::kThisOrOthersInMap; }
  /// Of a kSize: the logarithm of the size that it has, over the stated one.
  double log_scale() const { return kind == Kind::kSize && shape ? shape->log_scale : 0.0; }
};

}  // namespace apriltrack
