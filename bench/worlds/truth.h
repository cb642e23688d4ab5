#pragma once

#include <array>
#include <vector>

#include "world.h"

namespace apriltrack::worlds {

/// How one tag is seen at one moment, exactly.
struct TrueView {
  std::size_t tag = 0;                        ///< Index into World::tags.
  std::array<Eigen::Vector2d, 4> corners_px;  ///< Raw pixels, corner order.
  double view_angle_rad = 0.0;  ///< Between the tag's normal and the line of sight to its centre.
  double mean_side_px = 0.0;
  double shortest_side_px = 0.0;
  double blur_px = 0.0;           ///< Longest path of a corner in the exposure, first half plus second half.
  double visible_fraction = 0.0;  ///< Of the print: inside the image, and nothing before it.

  /// What a detector can be expected to find: the definition of bench/worlds/README.md.
  bool is_good() const;
};

inline constexpr double kLeastSide_px = 12.0;
inline constexpr double kSteepestView_deg = 75.0;
inline constexpr double kMostBlur_px = 3.0;

/// Tags that show their face under less than 85 degrees, with all corners before the lens and at least one in
/// the image.
std::vector<TrueView> true_views(const World& world, double time_s);

/// As if the camera were at T_world_camera, without blur.
std::vector<TrueView> views_from(const World& world, const Pose& T_world_camera, double time_s);

/// Frame by frame.
std::vector<std::vector<TrueView>> all_views(const World& world);

/// Indices of the most tags that frames with two good views join; each link by two frames at least.
std::vector<std::size_t> joined_tags(const World& world, const std::vector<std::vector<TrueView>>& frames);

}  // namespace apriltrack::worlds
