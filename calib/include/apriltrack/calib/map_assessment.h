#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "apriltrack/geometry/pose.h"
#include "apriltrack/tags/tag_key.h"

namespace apriltrack {

/// The direction in which a tag is known least, relative to the tag that it is best known by: a far tag is
/// not blamed for the chain that leads to it.
struct WeakDirection {
  TagKey tag;
  TagKey neighbour;
  bool is_rotation = false;
  /// Of unit length, in the tag's frame (x right, y down, z into it).
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  double sigma = 0.0;  ///< rad, or m.
  /// sigma over 0.02 rad, or over a tenth of the tag's size: above 1 it is weak.
  double weakness = 0.0;
  bool is_weak = false;
  std::string direction;  ///< "rotation about its x axis".
  std::string reason;     ///< What its views have in common: "3 frames, all head-on (within 8 degrees)".
  std::string words;      ///< A sentence of all that.
};

/// A part of the map that few moments tie to the rest.
struct HangingPart {
  std::vector<TagKey> tags;                          ///< The lesser side.
  int frames = 0;                                    ///< Moments that show tags of both sides.
  std::vector<TagKey> hinge_of_part, hinge_of_rest;  ///< The tags that these show.
  std::string words;
};

/// Two tags that moments show together.
struct SeenTogether {
  int tag_a = 0, tag_b = 0;  ///< Into TagMap::tags, a < b.
  int frames = 0;
  bool is_bridge = false;  ///< One of few moments that tie a HangingPart to the rest.
};

/// Pictures that would help most.
struct ViewAdvice {
  TagKey tag;                    ///< Whose pose they improve: the one that is known least.
  TagKey before, partner;        ///< Tags to be shown together, on the way from the gauge to that tag.
  std::vector<TagKey> together;  ///< All that the picture shows beside `tag`.
  int pictures = 0;
  double distance_m = 0.0;  ///< From the tag `before`.
  double aside_rad = 0.0;   ///< Off its normal: > 0 from the right of one who stands before it.
  double above_rad = 0.0;   ///< > 0 from above.
  Pose T_map_camera;        ///< Of the best picture.
  int camera = 0;           ///< Into the rig: that it was reckoned for.
  double sigma_before_m = 0.0, sigma_after_m = 0.0;  ///< Of the tag relative to the map's gauge.
  double sigma_before_rad = 0.0, sigma_after_rad = 0.0;
  std::string words;
};

/// What a map's covariance and views say of where it is weak, and what would help.
struct MapAssessment {
  /// One for each tag of the joint covariance but lone ones, in the order of the map.
  std::vector<WeakDirection> directions;
  std::vector<HangingPart> hanging;  ///< Fewest moments first.
  std::vector<SeenTogether> links;
  std::vector<ViewAdvice> advice;  ///< What helps most first; none where nothing helps much.
};

/// Two tags that should be filmed together, to join what no frame joins.
struct JoinAdvice {
  TagKey of_map, of_other;
  std::vector<TagKey> others;  ///< The part that would be joined; a tag that is in no map stands alone.
  /// Shortest time between a frame that shows the one and one that shows the other; none where that is too
  /// long to say that the two are near each other.
  std::optional<double> apart_s;
  std::string words;
};

}  // namespace apriltrack
