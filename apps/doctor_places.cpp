#include "doctor_places.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include "apriltrack/calib/calibrate_map.h"

namespace apriltrack::app {
namespace {

using SightKey = std::pair<std::string, TagKey>;

SightKey key_of(const Sight& sight) {
  return {sight.camera, sight.tag};
}

double rms_apart_px(const Sight& a, const Sight& b) {
  double squares = 0.0;
  for (std::size_t k = 0; k < kNumCorners; ++k) squares += (a.corners_px[k] - b.corners_px[k]).squaredNorm();
  return std::sqrt(squares / kNumCorners);
}

/// Of the same tags, in one order.
bool are_of_one_place(const Moment& a, const Moment& b, double most_px) {
  return std::ranges::equal(
      a, b, [&](const Sight& one, const Sight& other) { return rms_apart_px(one, other) <= most_px; });
}

}  // namespace

std::vector<bool> are_at_rest(std::span<const Moment> moments) {
  const double most_px = CalibrationOptions{}.same_place_px;
  std::map<std::vector<SightKey>, std::vector<Moment>> places;
  std::vector<bool> at_rest;
  for (Moment moment : moments) {
    std::ranges::stable_sort(moment, {}, key_of);
    std::vector<SightKey> keys;
    std::ranges::transform(moment, std::back_inserter(keys), key_of);
    std::vector<Moment>& known = places[keys];
    at_rest.push_back(std::ranges::any_of(
        known, [&](const Moment& place) { return are_of_one_place(moment, place, most_px); }));
    if (!at_rest.back()) known.push_back(std::move(moment));
  }
  return at_rest;
}

}  // namespace apriltrack::app
