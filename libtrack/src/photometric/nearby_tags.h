#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "apriltrack/photometric/photometric_world.h"
#include "view_path.h"

namespace apriltrack {

/// The tags that a camera may see from about where it is, so that what a state costs grows with the tags
/// around it and not with the map.
///
/// A tag is in sight of a view if its front is turned to the camera, its cells are not too small
/// (PhotometricTag::sight_m), and it may be in the image (may_be_in_view). A choice holds the tags that are
/// in sight of any view whose eye and whose optical axis lie within its margins; it serves until a view lies
/// beyond them. Such a view's eye is at most `reach` away, and its axis `turn` off, so that with d = |m - c|
/// for the eye c chosen about and a tag at m with normal n and radius r
///   - nearer than sight + reach: the way to the tag is shorter than d by `reach` at most;
///   - n . (m - c) > -reach: from the other eye it is more than 0;
///   - a ball of r + reach about m - c passes through the cone about the axis that is wider by `turn`: it
///     holds the ball of r about the way from the other eye to the tag, and the wider cone the other cone.
/// Groups of tags are left out together by the balls that hold them.
class NearbyTags {
 public:
  /// For tags that stay where they are.
  explicit NearbyTags(const std::vector<PhotometricTag>& tags);

  /// Indices, ascending, of all tags that are in sight of one of the path's three views, and of others. Valid
  /// until the next call.
  std::span<const std::uint32_t> of_path(const ViewPath& path, double max_view_angle_rad);

 private:
  struct Tag {
    Eigen::Vector3d centre_map, normal_map;
    double radius_m, sight_m;
    std::uint32_t index;
  };
  /// Tags in a row, in a ball.
  struct Group {
    Eigen::Vector3d centre_map = Eigen::Vector3d::Zero();
    double radius_m = 0.0;  ///< Its tags' balls and all.
    double sight_m = 0.0;   ///< The longest of its tags'.
    std::uint32_t first = 0, count = 0;
    std::uint32_t second_half = 0;  ///< Its group; the first half's is the next one. 0: none.
  };
  struct Eye {
    Eigen::Vector3d position_map, axis_map;
  };
  struct Choice {
    Eye eye;
    double reach_m = -1.0, turn_rad = 0.0, view_angle_rad = 0.0;
    std::vector<std::uint32_t> tags;
    std::uint64_t last_use = 0;

    bool holds(std::span<const Eye> eyes, double max_view_angle_rad) const;
  };

  static Eye eye_of(const MapView& view);
  void divide(std::uint32_t first, std::uint32_t count);
  Eigen::AlignedBox3d box_of_centres(std::uint32_t first, std::uint32_t count) const;
  Group group_of(std::uint32_t first, std::uint32_t count) const;
  void choose(std::span<const Eye> eyes, double max_view_angle_rad, Choice& choice) const;
  void add_in_sight(std::uint32_t group, Choice& choice) const;

  std::vector<Tag> tags_;      ///< Group by group.
  std::vector<Group> groups_;  ///< The first holds all.
  double usual_reach_m_ = 0.0;
  std::uint64_t num_calls_ = 0;
  /// Of late: hypotheses that are asked about in turn may lie apart.
  std::array<Choice, 4> choices_;
};

/// Whether a view shows the front of the tag, near enough for its cells to be told apart; whether it is in
/// the image is another matter.
bool is_front_in_sight(const PhotometricTag& tag, const MapView& view);

}  // namespace apriltrack
