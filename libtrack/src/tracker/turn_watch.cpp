#include "turn_watch.h"

#include <cstddef>
#include <utility>
#include <vector>

namespace apriltrack {

std::optional<SeenTurn> TurnWatch::turn(Timestamp time, const LightPyramid& light, const MotionMemory& motion,
                                        PhotometricWorld& world) {
  const Timestamp before = std::exchange(last_time_, time);
  const std::optional<CameraTurn> turn = gyroscope_.turn(light);
  // A turn of the last frame alone is none of a longer step.
  const MotionState* last = motion.at(before);
  if (!turn || last == nullptr) return std::nullopt;
  const std::vector<std::size_t> tags = world.tags_in_sight(*last);
  if (tags.empty()) return std::nullopt;
  const Pose view = camera_from_map(last->pose, world.mode);
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const std::size_t k : tags)
    middle += view * world.tags[k].tag.T_map_tag.translation() / static_cast<double>(tags.size());
  constexpr double kLeastDistance_m = 0.1;  // nearer, any way would look like a large turn
  if (!(middle.norm() >= kLeastDistance_m)) return std::nullopt;
  return SeenTurn{*turn, middle};
}

}  // namespace apriltrack
