#pragma once

#include <cstdint>
#include <vector>

#include "apriltrack/image/image.h"
#include "apriltrack/motion/motion_state.h"
#include "apriltrack/photometric/photometric_world.h"

namespace apriltrack {

/// Chooses where to look for the tags that the motion so far expects, so that reading tags does not cost more
/// than tracking them: about their places, as far as these are open, within a share of the image.
class TagRegions {
 public:
  /// Of tags that may be read: neither too small nor too blurred on the path expected. Those that were not
  /// looked at for longest come first; one at least, where there is any. Every region lies in the image.
  std::vector<ImageRegion> choose(PhotometricWorld& world, const MotionBelief& expected, double exposure_s,
                                  int width, int height);

 private:
  /// A readable tag's place.
  struct Place {
    std::size_t tag_index;
    ImageRegion region;
  };
  std::vector<Place> readable_places(PhotometricWorld& world, const MotionBelief& expected, double exposure_s,
                                     int width, int height) const;

  std::uint64_t num_calls_ = 0;
  std::vector<std::uint64_t> last_look_;  ///< By tag: the call that chose it last; 0: none.
};

}  // namespace apriltrack
