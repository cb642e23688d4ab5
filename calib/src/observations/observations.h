#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apriltrack/calib/calibration_options.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detection.h"
#include "apriltrack/tags/tag_sizes.h"
#include "observations/corner_noise.h"

namespace apriltrack {

/// One tag as one camera saw it in one frame.
struct TagView {
  int tag = 0;     ///< Into Observations::tags.
  int frame = 0;   ///< Into Observations::frames; views of several cameras at one time share the rig's pose.
  int camera = 0;  ///< Into Observations::cameras.
  CornersPx corners_px;
  Matrix8d whitening;  ///< Turns corner errors (px, x0 y0 x1 ...) into independent numbers of unit variance.
  Vector8d inward;     ///< How the corners move when all edges move inward by one pixel.
  int num_frames = 1;  ///< Whose mean it is: more than one where the scene stood still.
  int place = -1;  ///< From which its frame was taken, if others were taken from there, too; -1: none was.
  std::optional<Matrix8d> covariance_px2 =
      std::nullopt;  ///< Of the corners' errors, where a detector told it.
  /// Mean variance that the detector tells, of the whitened numbers without it, px^2; 0 where it tells none.
  double claimed_px2 = 0.0;
  std::size_t index = 0;  ///< Of the view, whatever others are merged or left out: into NoiseScale::of_view.
  /// What the view keeps in all of its tag's views, over CalibrationOptions::corner_bias_px: where its
  /// detector claims, it is as large as the claim (claimed_noise.h).
  double kept_share = 1.0;
  /// How errors of unit variance by EdgeNoise enter the whitened numbers: the identity without a covariance.
  Matrix8d by_model_errors = Matrix8d::Identity();

  /// Sets `whitening`, `by_model_errors` and `inward`. edges: corners that set the edges' directions.
  void set_noise(const CornersPx& edges, const EdgeNoise& noise);
};

struct RigCamera {
  CameraModel model;
  Pose T_camera_rig;
  /// The detector's edges lie so far inside the true ones, along their normals.
  double edge_offset_px = 0.0;
  std::string name = {};
};

/// What a calibration works on: every usable view, with small whole numbers in place of names.
struct Observations {
  std::vector<TagKey> tags;     ///< Sorted.
  std::vector<double> sizes_m;  ///< Of each tag; 0 where no size is known.
  std::vector<Timestamp> frames;
  std::vector<RigCamera> cameras;
  std::vector<TagView> views;  ///< Sorted by frame, then camera, then tag.
};

TagKey key_of(const Observations& observations, int tag);
std::vector<TagKey> keys_of(const Observations& observations, const std::vector<int>& tags);

/// How often an id was seen at several places of one image.
struct RepeatedTag {
  TagKey tag;
  std::size_t most_copies = 0;         ///< In one image.
  std::size_t frames = 0;              ///< That show it.
  std::size_t frames_with_copies = 0;  ///< Of these.

  /// More than chance: it is several tags, and none of them is used. Else it is not used in such frames.
  bool is_many_tags() const;
};
/// "... is not one tag: ...", with the way out.
std::string description_of(const RepeatedTag& tag);

/// What was seen and is not used.
struct UnusedDetections {
  std::size_t detections = 0;              ///< All there were.
  std::size_t unusable = 0;                ///< Of these, whose corners no tag can show.
  std::vector<RepeatedTag> repeated = {};  ///< Sorted; of which there is more than one at least once.
};

/// Drops corners that no tag can show (not finite, folded, mirrored, tiny, outside the lens model's domain)
/// and ids that are not unique, and counts them in `unused`. Throws Error(kNoResult) when nothing is left,
/// Error(kInvalidInput) when a camera is unknown, corners lie outside its pictures, or one of several has two
/// images of one time.
Observations collect_observations(std::span<const FrameDetections> frames, const CameraRig& rig,
                                  const TagSizes& sizes, const CalibrationOptions& options,
                                  UnusedDetections& unused);

/// Whether the corners are those of a tag as its front shows it, and not too small: finite, convex, in order.
bool is_quad_of_tag(const CornersPx& corners);

/// Mean length of the four edges.
double mean_edge_px(const CornersPx& corners);

/// "tag36h11/3, tag36h11/4 and 5 more".
std::string list_tags(std::span<const TagKey> keys, std::size_t limit = 20);

}  // namespace apriltrack
