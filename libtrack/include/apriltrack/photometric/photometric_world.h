#pragma once

#include <vector>

#include "apriltrack/camera/camera.h"
#include "apriltrack/motion/track_mode.h"
#include "apriltrack/photometric/light.h"
#include "apriltrack/photometric/pattern_texture.h"
#include "apriltrack/tags/tag_map.h"

namespace apriltrack {

/// A mapped tag with the pictures that it is compared with.
struct PhotometricTag {
  MapTag tag;
  PatternTextures textures;

  double half_size_m() const { return 0.5 * tag.size_m; }
};

/// What stays the same from frame to frame: the camera's rays and the tags' pictures.
struct PhotometricWorld {
  /// width, height: of the images. Throws Error(kInvalidInput) for a tag of an unknown family or id.
  PhotometricWorld(const Camera& camera, const TagMap& map, TrackMode mode, int width, int height);

  static constexpr int kNumLevels = 3;

  CameraModel model;
  TrackMode mode;
  PixelRays rays;
  std::vector<PhotometricTag> tags;  ///< In the order of the map.
  double psf_sigma_px = 0.5;         ///< Blur of the lens.

  double focal_px() const { return 0.5 * (model.pinhole().fx + model.pinhole().fy); }
};

/// One frame as the likelihood sees it.
struct PhotometricFrame {
  LightPyramid light;  ///< PhotometricWorld::kNumLevels levels.
  double exposure_s = 0.0;
};

}  // namespace apriltrack
