#pragma once

#include <optional>
#include <vector>

#include "apriltrack/base/parallel.h"
#include "numerics/linear_view.h"
#include "pictures/photometric_view.h"

namespace apriltrack {

/// What is seen, and of what: views sorted by moment.
struct PhotometricScene {
  std::vector<Camera> cameras;
  std::vector<Pose> T_camera_rig;
  std::vector<PrintedTag> tags;
  std::vector<PhotometricView> views;
};

/// What the views are explained by.
struct PhotometricState {
  std::vector<Pose> T_map_tag;
  std::vector<Pose> T_map_rig;       ///< Of each moment.
  std::vector<double> psf_sigma_px;  ///< Of each camera.
  std::vector<TagLight> lights;      ///< Of each tag.
};

/// Moves all poses as one body, so that the tag is there.
void put_tag(int tag, const Pose& T_map_tag, PhotometricState& state);

/// Views that disagree by more than this times the median of all, squared, are not of the tag alone.
inline constexpr double kOutlierOfMedian2 = 25.0;

/// What of the state may move. Poses of moments always do.
struct PhotometricFreedom {
  /// The others move; none: all tags stay. Where too few views show it, the tag that is seen most is held.
  std::optional<int> held_tag;
  bool is_light_free = true;  ///< And the lens blur.
};

/// Gauss-Newton on the light of all pixels, poses of the moments eliminated
/// (docs/algorithms/photometric_refinement.md).
class PhotometricAdjustment {
 public:
  /// scene: must outlive this.
  PhotometricAdjustment(const PhotometricScene& scene, PhotometricState state, ParallelFor parallel);

  /// On a fourth of the pixels until they settle, then on all. False where it does not settle in `max_steps`
  /// of either, or fails: the state is as good as it was then. Tags that are not solved for
  /// (tags_that_hang_together.h) stay where they are.
  bool run(const PhotometricFreedom& freedom, int max_steps);

  /// Takes part: views of those moments alone in which `is_chosen` says so.
  void choose_moments(const std::vector<bool>& is_chosen);

  const PhotometricState& state() const { return state_; }
  PhotometricState& state() { return state_; }
  /// Of the views that are explained, linearised at the state: whitened by what their pixels leave over.
  /// Errors that a tag keeps are of its corners, in pixels. Where tags moved, of those that hang together.
  std::vector<LinearView> linear_views();
  /// Squared residual of each view of the scene; nullopt where it takes no part, is an outlier or is not
  /// explained.
  std::vector<std::optional<double>> disagreements2();
  /// The tag that was held; -1 where none was.
  int held_tag() const { return held_tag_; }

 private:
  struct SeenView;

  Pose T_camera_tag(const PhotometricView& view) const;
  std::vector<SeenView> look(bool is_light_free, Pixels pixels);
  bool step(const PhotometricFreedom& freedom, Pixels pixels, double* worth);
  /// What the last step was worth; nullopt where one fails.
  std::optional<double> settle(const PhotometricFreedom& freedom, Pixels pixels, int max_steps);
  void drop_outliers(const std::vector<SeenView>& seen);
  /// Leaves out views of tags that cannot be solved for; holds one of the others.
  void keep_hanging_together(int wanted_tag, std::vector<LinearView>& views);
  void restore_unsolved(const PhotometricState& before);

  const PhotometricScene& scene_;
  PhotometricState state_;
  ParallelFor parallel_;
  std::vector<bool> takes_part_;  ///< Each view.
  // Of the last step in which tags moved:
  int held_tag_ = -1;
  std::vector<bool> is_solved_;  ///< Each tag, the held one too.
};

}  // namespace apriltrack
