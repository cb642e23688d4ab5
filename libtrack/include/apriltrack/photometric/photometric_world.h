#pragma once

#include <cstddef>
#include <memory>
#include <numbers>
#include <vector>

#include "apriltrack/camera/camera.h"
#include "apriltrack/motion/motion_state.h"
#include "apriltrack/motion/track_mode.h"
#include "apriltrack/photometric/light.h"
#include "apriltrack/photometric/pattern_textures.h"
#include "apriltrack/tags/tag_index.h"
#include "apriltrack/tags/tag_map.h"

namespace apriltrack {

/// A mapped tag as the likelihood sees it.
struct PhotometricTag {
  MapTag tag;
  std::size_t index = 0;     ///< Of its pattern in PhotometricWorld::textures.
  double half_extent = 0.0;  ///< Of its printed cells, in half tag sizes.
  Eigen::Matrix3d map_from_plane = Eigen::Matrix3d::Zero();  ///< (u, v, 1), in half tag sizes, to the map.
  Eigen::Vector3d normal_map = Eigen::Vector3d::Zero();      ///< Points into the tag.

  /// Farther off, nothing tells it from any other dark spot: its cells are too small.
  double sight_m = 0.0;

  /// Known to be behind something: takes no part in fits and scores until it is seen again.
  bool is_hidden = false;
  /// Hidden, and not looked for in this frame either.
  bool is_passed_over = false;

  double half_size_m() const { return 0.5 * tag.size_m; }
  /// Distance of the printed corners from the centre.
  double radius_m() const { return std::numbers::sqrt2 * half_extent * half_size_m(); }
};

struct PhotometricScratch;

/// What stays the same from frame to frame: the camera's rays and the tags' pictures. For one thread: fits
/// and scores mark its tags, make its pictures and use its memory.
struct PhotometricWorld {
  /// width, height: of the images. Throws Error(kInvalidInput) for a tag of an unknown family or id.
  PhotometricWorld(const Camera& camera, const TagMap& map, TrackMode mode, int width, int height);
  ~PhotometricWorld();
  PhotometricWorld(PhotometricWorld&&) noexcept;
  PhotometricWorld& operator=(PhotometricWorld&&) noexcept;

  /// For images of another size, or where none was known before.
  void fit_size(int width, int height);

  static constexpr int kNumLevels = 3;

  CameraModel model;
  TrackMode mode;
  PixelRays rays;
  std::vector<PhotometricTag> tags;  ///< In the order of the map; their places stay.
  TagIndex index;                    ///< Of the tags.
  /// Of the tags, by index; then, in the same order, what the tags of each one's family have in common.
  PatternTextures textures;
  double psf_sigma_px = 0.5;                     ///< Blur of the lens.
  double max_view_angle_rad = std::numbers::pi;  ///< Off the optical axis, of the farthest pixel.

  std::unique_ptr<PhotometricScratch> scratch;  ///< Memory to use again.

  /// Indices, ascending, of the tags that the state's pose may show: near enough, their front to the camera,
  /// and a part of them perhaps in the image. Costs what lies around the pose, not what the map holds.
  std::vector<std::size_t> tags_in_sight(const MotionState& state);

  /// By its index in the map, as evidence and observations name it.
  PhotometricTag& tag_at(int tag_index) { return tags[static_cast<std::size_t>(tag_index)]; }
  const PhotometricTag& tag_at(int tag_index) const { return tags[static_cast<std::size_t>(tag_index)]; }

  double focal_px() const { return 0.5 * (model.pinhole().fx + model.pinhole().fy); }
};

/// One frame as the likelihood sees it.
struct PhotometricFrame {
  LightPyramid light;  ///< PhotometricWorld::kNumLevels levels.
  double exposure_s = 0.0;
};

}  // namespace apriltrack
