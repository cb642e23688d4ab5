#pragma once

#include <cstddef>
#include <set>
#include <string>

#include "apriltrack/bag/bag_reader.h"
#include "apriltrack/source/bag_poses.h"

namespace apriltrack {

enum class PoseKind { kPose, kFoxglove, kPath, kTransforms };

/// The topics whose messages are read, all of one kind: one, or all with transforms.
struct PoseTopics {
  PoseKind kind = PoseKind::kPose;
  std::set<std::size_t> indices;
};

/// name: what messages call the bag. Throws Error(kInvalidInput) that lists the topics where none fits, or
/// several do.
PoseTopics choose_pose_topics(const BagReader& bag, const std::string& name, const BagPoseChoice& choice);

}  // namespace apriltrack
