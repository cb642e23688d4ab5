#include "viewpoints.h"

#include <map>
#include <set>
#include <utility>

#include "apriltrack/calib/calibrate_map.h"
#include "apriltrack/calib/camera_places.h"

namespace apriltrack {
namespace {

/// In the order in which they come up.
template <class Key>
class NumbersInOrder {
 public:
  int of(const Key& key) {
    return numbers_.try_emplace(key, static_cast<int>(numbers_.size())).first->second;
  }

 private:
  std::map<Key, int> numbers_;
};

}  // namespace

std::vector<std::vector<TagKey>> tags_by_viewpoint(std::span<const RigView> moments) {
  NumbersInOrder<std::string> cameras;
  NumbersInOrder<TagKey> tags;
  std::vector<std::vector<TagSight>> numbered;
  for (const RigView& moment : moments) {
    numbered.emplace_back();
    for (const ViewedTag& sight : moment)
      numbered.back().push_back({cameras.of(sight.camera), tags.of(sight.tag), sight.corners_px});
  }
  std::vector<std::set<TagKey>> seen;
  const auto places = find_camera_places(numbered, CalibrationOptions{}.same_place_px);
  for (std::size_t m = 0; m < moments.size(); ++m) {
    if (places[m] == seen.size()) seen.emplace_back();
    for (const ViewedTag& sight : moments[m]) seen[places[m]].insert(sight.tag);
  }
  std::vector<std::vector<TagKey>> result;
  for (const std::set<TagKey>& one : seen) result.emplace_back(one.begin(), one.end());
  return result;
}

}  // namespace apriltrack
