#pragma once

#include <optional>
#include <vector>

#include "apriltrack/base/parallel.h"
#include "linear_view.h"
#include "photometric_view.h"

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

/// What of the state may move. Poses of moments always do.
struct PhotometricFreedom {
  std::optional<int> held_tag;  ///< The others move; none: all tags stay.
  bool is_light_free = true;    ///< And the lens blur.
};

/// Gauss-Newton on the light of all pixels, poses of the moments eliminated
/// (docs/algorithms/photometric_refinement.md).
class PhotometricAdjustment {
 public:
  /// scene: must outlive this.
  PhotometricAdjustment(const PhotometricScene& scene, PhotometricState state, ParallelFor parallel);

  /// On a fourth of the pixels until they settle, then on all. False where it does not settle in `max_steps`
  /// of either, or fails: the state is as good as it was then.
  bool run(const PhotometricFreedom& freedom, int max_steps);

  /// Takes part: views of those moments alone in which `is_chosen` says so.
  void choose_moments(const std::vector<bool>& is_chosen);

  const PhotometricState& state() const { return state_; }
  PhotometricState& state() { return state_; }
  /// Of the views that are explained, linearised at the state: whitened by what their pixels leave over.
  /// Errors that a tag keeps are of its corners, in pixels.
  std::vector<LinearView> linear_views();

 private:
  struct SeenView;

  Pose T_camera_tag(const PhotometricView& view) const;
  std::vector<SeenView> look(bool is_light_free, Pixels pixels);
  bool step(const PhotometricFreedom& freedom, Pixels pixels, double* worth);
  /// What the last step was worth; nullopt where one fails.
  std::optional<double> settle(const PhotometricFreedom& freedom, Pixels pixels, int max_steps);
  void drop_outliers(const std::vector<SeenView>& seen);

  const PhotometricScene& scene_;
  PhotometricState state_;
  ParallelFor parallel_;
  std::vector<bool> takes_part_;  ///< Each view.
};

}  // namespace apriltrack
