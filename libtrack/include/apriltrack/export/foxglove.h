#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "apriltrack/base/timestamp.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/geometry/pose.h"

namespace apriltrack {

// Messages of Foxglove (https://docs.foxglove.dev/docs/visualization/message-schemas) as JSON texts, and
// their schemas: what an MCAP file or a live connection brings to its panels. All throw Error(kInvalidInput)
// for a time before 1970, which these messages cannot hold.

enum class FoxgloveType {
  kFrameTransform,
  kPoseInFrame,
  kSceneUpdate,
  kCameraCalibration,
  kCompressedImage,
  kImageAnnotations,
  kLog,
};

/// "foxglove.FrameTransform"
std::string_view foxglove_schema_name(FoxgloveType type);
/// The JSON schema of its messages: members, types and required names as Foxglove has them, without the
/// words.
std::string foxglove_schema(FoxgloveType type);

/// sRGB and opacity, 0 to 1 each.
struct SceneColour {
  double red = 0.0, green = 0.0, blue = 0.0, opacity = 1.0;
};

/// Lines through points in the entity's frame, metres; as wide on the screen whatever the distance.
struct SceneLine {
  std::vector<Eigen::Vector3d> points;
  bool is_closed = false;
  double width_px = 2.0;
  SceneColour colour;
};

/// A flat shape with four corners, in their order round it.
struct SceneQuad {
  std::array<Eigen::Vector3d, 4> corners;
  SceneColour colour;
};

/// Letters that face the viewer.
struct SceneText {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double height_m = 0.1;
  SceneColour colour;
  std::string text;
};

/// What is drawn in one frame of reference; it replaces what its topic drew under this id before.
struct SceneEntity {
  std::string frame;
  std::string id;
  std::vector<SceneLine> lines;
  std::vector<SceneQuad> quads;
  std::vector<SceneText> texts;
  std::vector<std::pair<std::string, std::string>> facts;  ///< Shown where the entity is clicked at.
};

/// A closed line in a picture. Pixels: (0, 0) is the centre of the top-left one, as everywhere; Foxglove's
/// origin is its corner, and half a pixel is added.
struct PictureOutline {
  std::vector<Eigen::Vector2d> corners_px;
  SceneColour colour;
  std::string text;  ///< At the first corner; empty: none.
};

enum class FoxgloveLevel { kDebug = 1, kInfo = 2, kWarning = 3, kError = 4 };

std::string frame_transform_json(Timestamp time, std::string_view parent, std::string_view child,
                                 const Pose& T_parent_child);
std::string pose_in_frame_json(Timestamp time, std::string_view frame, const Pose& T_frame_pose);
/// Without entities: everything that the topic drew goes away.
std::string scene_update_json(Timestamp time, std::span<const SceneEntity> entities);
/// Distortion plumb_bob, rational_polynomial or kannala_brandt (our equidistant); empty of a lens without
/// any.
std::string camera_calibration_json(Timestamp time, std::string_view frame, const Camera& camera);
/// bytes: of a picture as a file has them. format: "jpeg", "png", "webp".
std::string compressed_image_json(Timestamp time, std::string_view frame, std::string_view bytes,
                                  std::string_view format);
std::string image_annotations_json(Timestamp time, std::span<const PictureOutline> outlines);
std::string log_json(Timestamp time, FoxgloveLevel level, std::string_view name, std::string_view message);

}  // namespace apriltrack
