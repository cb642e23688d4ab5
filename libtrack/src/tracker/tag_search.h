#pragma once

#include "apriltrack/image/frame.h"
#include "apriltrack/motion/motion_state.h"
#include "apriltrack/photometric/photometric_world.h"
#include "blur_frame.h"
#include "tag_reader.h"
#include "tag_regions.h"

namespace apriltrack {

/// Where tags are looked for, in the frames of one recording. reader, world: must outlive it.
class TagSearch {
 public:
  TagSearch(TagReader& reader, PhotometricWorld& world) : reader_(reader), world_(world) {}

  /// As far as is needed where the motion goes on as expected: at the places of tags; at times at the whole
  /// image in half its resolution, for tags that nothing expects.
  void look(const Frame& frame, const MotionBelief& expected, BlurFrame& blur_frame);
  void look_everywhere(const Frame& frame, BlurFrame& blur_frame);
  /// After every frame: what was read in it.
  void were_read(const BlurFrame& blur_frame) { regions_.were_read(blur_frame.read); }

 private:
  TagReader& reader_;
  PhotometricWorld& world_;
  TagRegions regions_;
  Timestamp last_search_;  ///< Of the whole image.
};

}  // namespace apriltrack
