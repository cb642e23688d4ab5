#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "apriltrack/image/image.h"
#include "apriltrack/report/svg_picture.h"

namespace apriltrack {

/// T_scene_thing: takes coordinates of the thing to those of the scene, in metres.
struct ScenePose {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
};

/// What a tag, or a frame, is drawn as; its name stands in the legend.
struct SceneState {
  std::string name;
  SvgInk ink = SvgInk::kText;
  bool is_crossed = false;  ///< Of tags: drawn with a line through them.
};

/// A tag as it is printed. Its frame: x right, y down, z into the tag.
struct SceneTag {
  std::string name;                     ///< "tag36h11/7"; of one who points at it.
  std::string label;                    ///< "7": beside it.
  std::vector<std::string> notes = {};  ///< Further lines for one who points at it.
  ScenePose pose;
  double size_m = 0.0;
  std::string family;       ///< Tags of one family have as many cells.
  Image<float> cells;       ///< Row 0 on top: 0 black, 1 white, NaN where nothing is printed.
  int width_at_border = 0;  ///< Cells across the square whose edge is size_m.
  std::optional<Eigen::Matrix3d> covariance_m2 = std::nullopt;  ///< Of the position, along the scene's axes.
  std::size_t state = 0;
};

struct ScenePoint {
  double time_s = 0.0;
  std::optional<ScenePose> pose;
  std::size_t state = 0;
};

/// What moves in a scene.
enum class SceneMotion {
  kNothing,
  kCamera,  ///< The path is T_scene_camera.
  kTags     ///< The path is T_camera_tags: the scene is the camera's, and tags' poses are of their own frame.
};

/// A scene that is turned about on a page. Camera frame: x right, y down, z forward.
struct SceneView {
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();       ///< Of length 1.
  std::optional<Eigen::Vector3d> from = std::nullopt;  ///< Direction from which it is seen first.
  std::vector<SceneState> tag_states = {};             ///< Of tags.
  std::vector<SceneTag> tags = {};
  double ellipsoid_scale = 1.0;  ///< By how much ellipsoids of one sigma are drawn too large at first.
  SceneMotion motion = SceneMotion::kNothing;
  std::vector<SceneState> path_states = {};
  std::string path_name = "path";
  std::vector<ScenePoint> path = {};  ///< In the order of time; empty where nothing moves.
  std::string true_path_name = "truth";
  std::vector<ScenePoint> true_path = {};
  /// x / z of the picture's right edge and y / z of its lower one: of the marker that shows where the camera
  /// looks.
  Eigen::Vector2d view_tangents = {0.6, 0.45};
};

/// Frames of a path that a page shows at most; of longer ones every second, third, ... one.
inline constexpr std::size_t kMostPathFrames = 5000;
/// 1, or every how many-th frame of so long a path is shown.
std::size_t path_stride(std::size_t num_frames);

/// The scene as JSON for a page: no letter in it ends a script or an element. Lengths are rounded to 0.01 mm,
/// rotations to 1e-5, covariances to four digits. Requires states that are there, finite numbers, and cells
/// that are as many as those of the family's other tags.
std::string scene_json(const SceneView& scene);

}  // namespace apriltrack
