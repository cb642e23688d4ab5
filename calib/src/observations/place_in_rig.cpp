#include "observations/place_in_rig.h"

#include <algorithm>

namespace apriltrack {

Pose place_in_rig(const CameraRig& rig, std::size_t index, bool is_one_of_several) {
  const auto first = rig.cameras.begin() + 1;
  const bool is_known = std::all_of(first, first + static_cast<std::ptrdiff_t>(index),
                                    [](const Camera& one) { return one.T_this_previous.has_value(); });
  return is_one_of_several || is_known ? rig.T_camera_rig(index) : Pose::identity();
}

}  // namespace apriltrack
