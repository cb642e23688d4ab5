#pragma once

#include <vector>

#include "apriltrack/sim/renderer.h"
#include "lens.h"
#include "panel_view.h"
#include "room_view.h"

namespace apriltrack {

/// A scene with what does not change from frame to frame.
struct PreparedScene {
  PreparedScene(const Scene& scene);

  struct PreparedBody {
    const Body* body = nullptr;
    std::vector<PreparedPanel> panels;
    Eigen::Vector3d centre_body = Eigen::Vector3d::Zero();
    bool lies_on_walls = false;  ///< Nothing but decals.
    bool is_fixed = false;
  };

  const Scene* scene;
  ViewGrid grid;
  std::vector<PreparedBody> bodies;
  bool is_camera_fixed;
};

/// Instants in the middle of equal parts of the exposure.
struct Instants {
  double start_s = 0.0;
  double step_s = 0.0;
  int count = 1;

  double at(int index) const { return start_s + step_s * (index + 0.5); }
};

/// As many as the longest path seen asks for, rounded up to a multiple of `multiple_of`. exposure_s = 0: that
/// many at once.
Instants choose_instants(const PreparedScene& prepared, double middle_s, double exposure_s,
                         const RenderOptions& options, int multiple_of);

/// Mean radiance of every pixel over its area, the instants and the blur of the lens, whose looks take turns:
/// the instants' number must be a multiple of the looks'.
Image<float> film(const PreparedScene& prepared, const Instants& instants, const Lens& lens);

}  // namespace apriltrack
