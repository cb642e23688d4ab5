#include "tag_search.h"

#include <array>

namespace apriltrack {
namespace {

/// How often the whole image is glanced at for tags that nothing expects, and how coarsely.
constexpr double kGlanceInterval_s = 1.0;
constexpr double kGlanceDecimate = 2.0;

}  // namespace

void TagSearch::look(const Frame& frame, const MotionBelief& expected, BlurFrame& blur_frame) {
  const GrayView& image = frame.image;
  if (seconds_between(last_search_, frame.timestamp) >= kGlanceInterval_s) {
    last_search_ = frame.timestamp;
    const std::array whole = {TagRegion{{0, 0, image.width(), image.height()}, {}}};
    return reader_.read_in(image, whole, kGlanceDecimate, blur_frame);
  }
  const std::vector<TagRegion> regions =
      regions_.choose(world_, expected, blur_frame.photometric.exposure_s, image.width(), image.height());
  reader_.read_in(image, regions, 1.0, blur_frame);
}

void TagSearch::look_everywhere(const Frame& frame, BlurFrame& blur_frame) {
  last_search_ = frame.timestamp;
  reader_.read(frame.image, blur_frame);
  blur_frame.is_searched = true;
}

}  // namespace apriltrack
