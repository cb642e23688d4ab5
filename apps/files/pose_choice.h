#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "apriltrack/source/bag_poses.h"

namespace apriltrack::app {

/// `--topic` and `--transform` of a command that reads two trajectories, as they were given: NAME, or
/// truth=NAME and estimate=NAME.
struct PoseChoices {
  std::vector<std::string> topics;
  std::vector<std::string> transforms;
};

/// Of a command that reads one trajectory.
void add_pose_choice_options(CLI::App& command, BagPoseChoice& choice);
void add_pose_choice_options(CLI::App& command, PoseChoices& choices);

/// What they say of the trajectory `role` ("truth", "estimate"), which is read of `path`. What is said of
/// both is of those that are bags. Throws Error(kInvalidInput) where a role is none of these or has two.
BagPoseChoice choice_for(const std::string& role, const std::string& path, const PoseChoices& choices);

/// Throws Error(kInvalidInput) where something is said of both, and neither is a bag.
void check_pose_choices(const PoseChoices& choices, const std::vector<std::string>& paths);

}  // namespace apriltrack::app
