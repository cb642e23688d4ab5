#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apriltrack/base/timestamp.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/sim/image_formation.h"
#include "apriltrack/sim/motion.h"
#include "apriltrack/sim/texture.h"
#include "apriltrack/tags/tag_family.h"
#include "apriltrack/tags/tag_map.h"

namespace apriltrack {

/// How a tag is printed.
struct TagPrint {
  /// White paper round the family's printed cells, in cells. tag36h11 prints one white cell round its black
  /// border itself, so that the white rim of the default is 1.5 cells wide.
  double margin_cells = 0.5;
  double ink = 0.035;   ///< Reflectance of black.
  double paper = 0.80;  ///< Reflectance of white.
};

/// A flat rectangle with one visible side. Panel frame as a tag's: x right, y down, z INTO the surface.
struct Panel {
  Pose T_body_panel;
  Eigen::Vector2d half_size_m = Eigen::Vector2d::Zero();
  double reflectance = 0.5;               ///< Of a plain panel, and of a tag's paper.
  double ink = 0.0;                       ///< Of a tag's black cells.
  std::shared_ptr<const TagPattern> tag;  ///< Printed in the middle; null: a plain or pictured panel.
  double cell_m = 0.0;                    ///< Edge of one cell of the tag.
  /// Where the tag's middle lies in the panel; beyond its border, too, where the panel is a strip of a print.
  Eigen::Vector2d tag_centre_m = Eigen::Vector2d::Zero();
  std::shared_ptr<const Texture> picture;  ///< Reflectance over the whole panel; null: none.
  /// Share of the light from behind that the panel stops, over the whole panel; null: all. With a reflectance
  /// of 0 this is a shadow. Not of a tag; of the same texel size as the picture.
  std::shared_ptr<const Texture> opacity;
  /// Gloss: radiance that the lamp's mirror image adds in its middle, and the standard deviation of its lobe.
  double gloss = 0.0;
  double gloss_width_rad = 0.05;
  /// Lies on another panel or on a wall, and is painted over what the body shows so far; else the panel is a
  /// side of a convex solid whose sides meet without a gap.
  bool is_decal = false;
};

/// Things that move together. Solids are convex: sides that face away are not seen, and need no sorting.
struct Body {
  std::string name;
  Motion T_world_body;
  bool moves_with_camera = false;  ///< T_world_body is T_camera_body then: a hand before the lens.
  std::vector<Panel> panels;
};

/// The surroundings: a box seen from inside, light baked in. Faces: -x, +x, -y, +y, -z, +z. A face is spanned
/// by the two other axes in cyclic order (x: y z; y: z x; z: x y), texel (0, 0) at their smallest values.
struct Room {
  Eigen::Vector3d min_corner = Eigen::Vector3d::Zero();
  Eigen::Vector3d max_corner = Eigen::Vector3d::Zero();
  std::array<std::shared_ptr<const Texture>, 6> radiance;
};

/// Irradiance in units in which a white, fully lit surface sends out 1: ambient light plus one lamp, with a
/// smooth fall over distance: ambient + intensity * cos / (1 + distance^2 / reach^2), cos clamped smoothly at
/// zero.
struct Lighting {
  Eigen::Vector3d lamp_world = Eigen::Vector3d::Zero();
  double ambient = 0.35;
  double intensity = 0.8;
  double reach_m = 3.0;

  double irradiance(const Eigen::Vector3d& point_world, const Eigen::Vector3d& outward_normal_world) const;
};

/// Lamps on alternating current: light(t) = 1 + depth * sin(2 pi frequency_hz t + phase_rad). It acts inside
/// the exposure, and the mean over the exposure goes into the frame's gain.
struct Flicker {
  double depth = 0.0;
  double frequency_hz = 100.0;
  double phase_rad = 0.0;

  double light(double time_s) const;
};

/// Frames first, ..., first + count - 1 of a recording.
struct FrameSpan {
  std::size_t first = 0;
  std::size_t count = 0;
};

/// Whether truth is the camera in the world, or a body before the camera.
enum class TruthKind { kEgo, kJoint };

/// A world with everything that is needed to film it, truth included. Plain data: build your own, or take a
/// named one.
struct Scene {
  std::string name;
  Camera camera{.name = "cam0", .model = CameraModel(Pinhole{500, 500, 319.5, 239.5}, NoDistortion{})};
  Motion T_world_camera;
  std::optional<Room> room;  ///< None: black surroundings.
  Lighting lighting;
  Flicker flicker;
  std::vector<Body> bodies;
  TruthKind truth = TruthKind::kEgo;
  std::size_t truth_body = 0;  ///< The body that carries the map's tags.
  TagMap map;                  ///< In the frame of the truth body.
  ImageFormation formation;
  std::vector<FrameSpan> blackouts;  ///< No light reaches the sensor, and no one tells the camera.

  double rate_hz = 30.0;
  double exposure_s = 0.016;
  std::size_t num_frames = 300;
  std::int64_t start_ns = 50'000'000;

  /// Middle of the exposure of frame `index`.
  Timestamp timestamp(std::size_t index) const;
  bool is_blacked_out(std::size_t index) const;
  Pose T_world_body(const Body& body, double time_s) const;
  /// Ego: T_map_camera; joint: T_camera_body. Exact at any instant.
  Pose truth_pose(Timestamp time) const;
  /// Ego: the inverse of the truth; joint: the truth itself.
  Pose T_camera_map(double time_s) const;
};

/// Prints the tags of `map` as decals of `body`, whose frame is the map's. Throws what check_tag_map()
/// throws.
void add_tags(Body& body, const TagMap& map, const TagPrint& print = {});

/// How a sheet is bent: rolled about its upright middle line, and twisted about its level one.
struct Bend {
  double curl_rad =
      0.0;  ///< Between the normals of the left and the right border; > 0: the borders come forward.
  double twist_rad = 0.0;  ///< Between the upright lines of the left and the right border.
  double width_m = 1.0;    ///< Of the sheet.

  /// Where the point (u, v) of the flat sheet lies; frame of a tag, the sheet's middle at the origin.
  Eigen::Vector3d at(double u_m, double v_m) const;
};

/// A tag on a bent sheet of white paper of its own, as upright flat strips. `body` must have no other panels
/// but those of such sheets. bend.width_m is not regarded: the sheet is as wide as the print with its margin.
/// Returns the bend with that width.
Bend add_bent_tag(Body& body, const MapTag& tag, Bend bend, const TagPrint& print = {});

/// A box with its centre at T_body_box: six plain sides.
void add_box(Body& body, const Pose& T_body_box, const Eigen::Vector3d& size_m, double reflectance);

/// A thin plate seen from both sides, pictured in front (the -z side of the panel frame).
void add_plate(Body& body, const Pose& T_body_plate, const Eigen::Vector2d& half_size_m, double reflectance,
               std::shared_ptr<const Texture> picture = nullptr);

/// A whole printed Kalibr grid on white paper: rows x cols tags of family tag36h11b2, id = row * cols + col
/// from the bottom left, gaps of spacing_ratio * size, and black squares of that edge at every crossing, the
/// outer ones included. Frame of the grid as a tag's, origin in its middle. Returns the map of its tags in
/// the body's frame.
TagMap add_kalibr_grid(Body& body, const Pose& T_body_grid, int rows, int cols, double tag_size_m,
                       double spacing_ratio);

}  // namespace apriltrack
