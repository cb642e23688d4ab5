#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apriltrack/base/timestamp.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/export/foxglove.h"
#include "apriltrack/tags/tag_map.h"
#include "tag_sights.h"

namespace apriltrack::app {

// What the 3D panel and the image panel show of a run.

/// The same in the scene and in the picture.
SceneColour colour_of(SightStatus status);

/// All tags of the map, outlined and numbered, in the map's frame: what is out of view stays grey.
SceneEntity map_entity(const TagMap& map, const std::string& frame);
/// The tags in view, each with the colour of its status, in the map's frame.
SceneEntity sights_entity(std::span<const TagSight> sights, const TagMap& map, const std::string& frame);
/// Four rays through the corners of the picture; none where the camera's resolution is not known, or the lens
/// does not reach the corners.
std::optional<SceneEntity> frustum_entity(const Camera& camera, const TagMap& map, const std::string& frame);
/// The tags in view where the pose puts them.
std::vector<PictureOutline> sight_outlines(std::span<const TagSight> sights);

/// The path so far, of a thousand points at most: the longer it is, the fewer of its points it keeps.
class PathSoFar {
 public:
  void add(const Eigen::Vector3d& position);
  SceneEntity entity(const std::string& frame) const;

 private:
  std::vector<Eigen::Vector3d> points_;
  std::optional<Eigen::Vector3d> last_;
  std::size_t step_ = 1;  ///< One in so many positions is kept.
  std::size_t num_added_ = 0;
};

}  // namespace apriltrack::app
