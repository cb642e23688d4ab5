#include "doctor_places.h"

#include <map>
#include <set>
#include <utility>

#include "apriltrack/calib/calibrate_map.h"
#include "apriltrack/calib/camera_places.h"

namespace apriltrack::app {
namespace {

/// In the order in which they come up.
template <class Key>
class Numbers {
 public:
  int of(const Key& key) {
    return numbers_.try_emplace(key, static_cast<int>(numbers_.size())).first->second;
  }

 private:
  std::map<Key, int> numbers_;
};

}  // namespace

std::vector<std::vector<TagKey>> tags_by_place(std::span<const Moment> moments) {
  Numbers<std::string> cameras;
  Numbers<TagKey> tags;
  std::vector<std::vector<TagSight>> numbered;
  for (const Moment& moment : moments) {
    numbered.emplace_back();
    for (const Sight& sight : moment)
      numbered.back().push_back({cameras.of(sight.camera), tags.of(sight.tag), sight.corners_px});
  }
  std::vector<std::set<TagKey>> seen;
  const auto places = find_camera_places(numbered, CalibrationOptions{}.same_place_px);
  for (std::size_t m = 0; m < moments.size(); ++m) {
    if (places[m] == seen.size()) seen.emplace_back();
    for (const Sight& sight : moments[m]) seen[places[m]].insert(sight.tag);
  }
  std::vector<std::vector<TagKey>> result;
  for (const std::set<TagKey>& one : seen) result.emplace_back(one.begin(), one.end());
  return result;
}

}  // namespace apriltrack::app
