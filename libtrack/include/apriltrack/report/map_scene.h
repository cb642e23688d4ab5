#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apriltrack/report/scene_view.h"
#include "apriltrack/tags/tag_map.h"

namespace apriltrack {

/// A pose as a scene has it; the scene's frame is the map's.
ScenePose scene_pose(const Pose& T_scene_thing);

/// A tag's name in drawings: its id alone if all tags of the map are of one family, else "family/id".
std::string short_name(const TagMap& map, const MapTag& tag);

/// Root mean square length of the position's error (m) and angle of the rotation's (rad), as a covariance
/// expects them.
double position_sigma_m(const Matrix6d& covariance);
double rotation_sigma_rad(const Matrix6d& covariance);
/// Covariance of a tag's position along the map's axes, m^2. Requires that the tag has a covariance.
Eigen::Matrix3d position_covariance(const MapTag& tag);
/// Whether the map's gauge holds the tag: its covariance is zero.
bool is_held(const MapTag& tag);

/// For people, a line each: size, place, sigma, views and flags.
std::vector<std::string> notes_of(const MapTag& tag);

/// The tag as it is printed, at its place in the map. state: its index in SceneView::tag_states.
SceneTag scene_tag(const TagMap& map, const MapTag& tag, std::size_t state);

/// The tags of a map that nothing moves in; those with flags stand out. up: in the map's frame, of length 1.
/// ellipsoid_scale: as in the page's other drawings.
SceneView scene_of_map(const TagMap& map, const Eigen::Vector3d& up, double ellipsoid_scale);

}  // namespace apriltrack
