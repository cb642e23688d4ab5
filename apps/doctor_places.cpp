#include "doctor_places.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "apriltrack/calib/calibrate_map.h"

namespace apriltrack::app {
namespace {

/// In the order of their keys, so that two frames are compared tag by tag.
std::vector<const SeenTag*> sorted_tags(const FrameFacts& frame) {
  std::vector<const SeenTag*> tags;
  for (const SeenTag& tag : frame.tags) tags.push_back(&tag);
  std::ranges::stable_sort(tags, {}, &SeenTag::tag);
  return tags;
}

double rms_apart_px(const SeenTag& a, const SeenTag& b) {
  double squares = 0.0;
  for (std::size_t k = 0; k < kNumCorners; ++k) squares += (a.corners_px[k] - b.corners_px[k]).squaredNorm();
  return std::sqrt(squares / kNumCorners);
}

bool are_of_one_place(const std::vector<const SeenTag*>& a, const std::vector<const SeenTag*>& b) {
  static const double most_px = CalibrationOptions{}.same_place_px;
  return std::ranges::equal(
      a, b, [](const SeenTag* one, const SeenTag* other) { return rms_apart_px(*one, *other) <= most_px; });
}

}  // namespace

std::vector<bool> are_at_rest(std::span<const FrameFacts> frames) {
  std::map<std::vector<TagKey>, std::vector<std::vector<const SeenTag*>>> places;
  std::vector<bool> at_rest;
  for (const FrameFacts& frame : frames) {
    const std::vector<const SeenTag*> tags = sorted_tags(frame);
    std::vector<TagKey> keys;
    for (const SeenTag* tag : tags) keys.push_back(tag->tag);
    auto& known = places[keys];
    const bool is_known =
        std::ranges::any_of(known, [&](const auto& place) { return are_of_one_place(tags, place); });
    at_rest.push_back(is_known && !tags.empty());
    if (!is_known) known.push_back(tags);
  }
  return at_rest;
}

}  // namespace apriltrack::app
