#include "apriltrack/calib/camera_places.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <unordered_map>
#include <utility>

#include "apriltrack/base/disjoint_sets.h"

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

struct Comparison {
  std::size_t shared = 0, agreeing = 0;
  std::set<int> cameras;  ///< Of those that are shared.

  bool agrees() const {
    return shared > 0 && static_cast<double>(agreeing) > kAgreeing * static_cast<double>(shared);
  }
};

Comparison compare(const FirstCorners& place, const Sights& moment, double same_place_px) {
  Comparison result;
  for (const TagSight& sight : moment) {
    const auto there = place.find({sight.camera, sight.tag});
    if (there == place.end()) continue;
    ++result.shared;
    result.cameras.insert(sight.camera);
    if (rms_apart_px(there->second, sight.corners_px) <= same_place_px) ++result.agreeing;
  }
  return result;
}

bool is_at(const FirstCorners& place, const Sights& moment, double same_place_px) {
  const Comparison one = compare(place, moment, same_place_px);
  return 2 * one.shared > moment.size() && one.agrees();
}

Sights sights_of(const FirstCorners& place) {
  Sights sights;
  for (const auto& [sight, corners_px] : place) sights.push_back({sight.first, sight.second, corners_px});
  return sights;
}

std::set<int> cameras_of(const FirstCorners& place) {
  std::set<int> cameras;
  for (const auto& [sight, corners_px] : place) cameras.insert(sight.first);
  return cameras;
}

/// Of a rig all cameras must have stood still: each that saw anything at either saw something at both.
bool are_one(const FirstCorners& a, const FirstCorners& b, double same_place_px) {
  const Comparison one = compare(a, sights_of(b), same_place_px);
  return one.agrees() && 2 * one.shared >= std::min(a.size(), b.size()) && one.cameras == cameras_of(a) &&
         one.cameras == cameras_of(b);
}

/// Moments that had no sight in common are joined by what came later: each place with all that it is one
/// with, and these with what they are one with together.
DisjointSets joined_places(std::vector<FirstCorners> places, const PlaceIndex& index, double same_place_px) {
  DisjointSets joined(places.size());
  const auto join_one = [&](std::size_t place) {
    const std::size_t own = joined.find(place);
    for (const std::size_t near : index.near(sights_of(places[own]))) {
      const std::size_t other = joined.find(near);
      if (other == own || !are_one(places[other], places[own], same_place_px)) continue;
      joined.join(own, other);
      const std::size_t both = joined.find(own);
      FirstCorners& rest = places[both == own ? other : own];
      places[both].merge(rest);
      return true;
    }
    return false;
  };
  for (std::size_t place = 0; place < places.size(); ++place) {
    while (join_one(place)) continue;
  }
  return joined;
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
  DisjointSets joined = joined_places(std::move(places), index, same_place_px);
  std::map<std::size_t, std::size_t> numbers;
  for (std::size_t& place : result)
    place = numbers.try_emplace(joined.find(place), numbers.size()).first->second;
  return result;
}

}  // namespace apriltrack
