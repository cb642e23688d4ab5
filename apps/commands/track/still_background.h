#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "apriltrack/base/timestamp.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/image/image.h"
#include "apriltrack/tags/tag_map.h"

namespace apriltrack::app {

/// Notices a body of tags before a camera at rest that is tracked as if the camera moved through a world of
/// tags.
///
/// Where the camera turns by some degrees, everything in its picture moves, however far away it is: shifts by
/// the camera's own translation cancel that at one distance at most. So pieces of the picture beside the tags
/// that stay where they are, while the poses say that the camera has turned, say that it has not.
class StillBackground {
 public:
  StillBackground(const Camera& camera, const TagMap& map) : camera_(camera), map_(map) {}

  /// Frame by frame, in order; T_world_camera: of frames whose pose rests on a detection.
  void add(Timestamp time, const GrayView& image, const Pose& T_world_camera);

  /// What to ask, once it is beyond doubt; nullopt otherwise.
  std::optional<std::string> told() const;

 private:
  /// A picture four times smaller, and where in it tags of the map, or the edge of the lit part, may hide the
  /// background.
  struct Reference {
    Timestamp time;
    Pose T_world_camera;
    Image<float> small;
    std::vector<bool> is_hidden;  ///< Of its pieces, row by row.
  };

  Reference reference(Timestamp time, const GrayView& image, const Pose& T_world_camera) const;
  void compare(const Reference& before, const Reference& now);

  const Camera& camera_;
  const TagMap& map_;
  std::optional<Reference> last_;
  std::size_t pairs_ = 0;
  std::size_t textured_ = 0;  ///< Pieces that would show a shift.
  std::size_t still_ = 0;     ///< Those of them that did not move.
};

}  // namespace apriltrack::app
