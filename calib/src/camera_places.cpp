#include "apriltrack/calib/camera_places.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <unordered_map>
#include <utility>

namespace apriltrack {
namespace {

constexpr double kAgreeing = 0.75;  ///< Of the sights that a moment shares with its place.

using Sights = std::vector<TagSight>;

/// By camera and tag, as seen first.
using FirstCorners = std::map<std::pair<int, int>, std::array<Eigen::Vector2d, kNumCorners>>;

double rms_apart_px(const std::array<Eigen::Vector2d, kNumCorners>& a,
                    const std::array<Eigen::Vector2d, kNumCorners>& b) {
  double squares = 0.0;
  for (std::size_t i = 0; i < kNumCorners; ++i) squares += (a[i] - b[i]).squaredNorm();
  return std::sqrt(squares / kNumCorners);
}

/// Finds places by where a tag's first corner lies: a grid as wide as it may move.
class PlaceIndex {
 public:
  explicit PlaceIndex(double same_place_px) : cell_px_(2.0 * same_place_px) {}

  void add(const TagSight& sight, std::size_t place) { places_[key(sight, 0, 0)].push_back(place); }

  /// Rising, each once; perhaps too many, never too few.
  std::vector<std::size_t> near(const Sights& moment) const {
    std::vector<std::size_t> result;
    for (const TagSight& sight : moment) {
      for (const int dx : {-1, 0, 1}) {
        for (const int dy : {-1, 0, 1}) {
          const auto found = places_.find(key(sight, dx, dy));
          if (found != places_.end()) result.insert(result.end(), found->second.begin(), found->second.end());
        }
      }
    }
    std::ranges::sort(result);
    result.erase(std::unique(result.begin(), result.end()), result.end());
    return result;
  }

 private:
  /// Of two cells with one key all are looked at, and the corners decide.
  std::uint64_t key(const TagSight& sight, int dx, int dy) const {
    const auto cell = [&](double px, int d) {
      return static_cast<std::uint64_t>(
                 static_cast<std::int64_t>(std::floor(std::clamp(px / cell_px_, -1e9, 1e9))) + d) &
             0xfffffu;
    };
    const auto of_sight =
        static_cast<std::uint64_t>(sight.camera) * 40961u + static_cast<std::uint64_t>(sight.tag);
    return (of_sight << 40) | (cell(sight.corners_px[0].x(), dx) << 20) | cell(sight.corners_px[0].y(), dy);
  }

  double cell_px_;
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> places_;
};

bool is_at(const FirstCorners& place, const Sights& moment, double same_place_px) {
  std::size_t shared = 0, agreeing = 0;
  for (const TagSight& sight : moment) {
    const auto there = place.find({sight.camera, sight.tag});
    if (there == place.end()) continue;
    ++shared;
    if (rms_apart_px(there->second, sight.corners_px) <= same_place_px) ++agreeing;
  }
  return 2 * shared > moment.size() &&
         static_cast<double>(agreeing) > kAgreeing * static_cast<double>(shared);
}

}  // namespace

std::vector<std::size_t> find_camera_places(std::span<const std::vector<TagSight>> moments,
                                            double same_place_px) {
  std::vector<FirstCorners> places;
  PlaceIndex index(same_place_px);
  std::vector<std::size_t> result;
  for (const Sights& moment : moments) {
    const std::vector<std::size_t> near = index.near(moment);
    const auto own =
        std::ranges::find_if(near, [&](std::size_t p) { return is_at(places[p], moment, same_place_px); });
    const std::size_t p = own == near.end() ? places.size() : *own;
    if (p == places.size()) places.emplace_back();
    for (const TagSight& sight : moment) {
      if (places[p].emplace(std::pair(sight.camera, sight.tag), sight.corners_px).second) index.add(sight, p);
    }
    result.push_back(p);
  }
  return result;
}

}  // namespace apriltrack
