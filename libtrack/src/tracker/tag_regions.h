#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "apriltrack/detect/detector.h"
#include "apriltrack/image/image.h"
#include "apriltrack/motion/motion_state.h"
#include "apriltrack/photometric/photometric_world.h"
#include "tag_observation.h"

namespace apriltrack {

/// Chooses where to look for the tags that the motion so far expects, so that reading tags does not cost more
/// than tracking them: about their places, as far as these are open, within a share of the image.
class TagRegions {
 public:
  /// Of tags that may be read: neither too small nor too blurred on the path expected. First those that were
  /// read before, for these are likely to be read again, then the others; of each, those that were not looked
  /// at for longest. One at least, where there is any. Every region lies in the image, and is for its tag's
  /// family alone.
  std::vector<TagRegion> choose(PhotometricWorld& world, const MotionBelief& expected, double exposure_s,
                                int width, int height);

  /// After every frame: the tags that were read in it, by index.
  void were_read(const std::vector<TagObservation>& observations);

 private:
  /// A readable tag's place.
  struct Place {
    std::size_t tag_index;
    ImageRegion region;
  };
  std::vector<Place> readable_places(PhotometricWorld& world, const MotionBelief& expected, double exposure_s,
                                     int width, int height) const;

  struct Looked {
    bool was_read = false;
    std::uint64_t last = 0;  ///< The call that chose it last; 0: none.
  };
  std::uint64_t num_calls_ = 0;
  std::map<std::size_t, Looked> looked_;  ///< By tag: those that were chosen or read.
};

}  // namespace apriltrack
