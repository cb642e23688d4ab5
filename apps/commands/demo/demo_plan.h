#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "apriltrack/motion/track_mode.h"

namespace apriltrack::app {

struct DemoOptions {
  std::string output;
  std::uint64_t seed = 1;
  int threads = 0;
  int num_frames = 140;  ///< Of the room's recording; the bodies' are half as long.
};

/// What the demo tracks: a rendered scene, and what moves in it.
struct DemoScene {
  const char* name;
  TrackMode mode;
  const char* story;
  int num_parts;      ///< Frames: the room's over this.
  const char* speed;  ///< Of the motion along its path; 1: detection just holds on to the bodies.
};
inline constexpr std::array<DemoScene, 3> kDemoScenes = {
    {{"room", TrackMode::kEgo, "A camera in a violent hand, in a room of tags; map calibrated from images", 1,
      "1"},
     {"bundle", TrackMode::kJoint, "A tumbling body of tags before a still camera", 2, "1.6"},
     {"single", TrackMode::kJoint, "A single tag, thrown about before a still camera", 2, "1.6"}}};

/// Today's practice, the seed paper, and this library's own.
inline constexpr std::array<const char*, 3> kDemoMethods = {"pnp", "paper", "blur"};

/// Where the demo's files lie, beneath --output.
struct DemoFiles {
  std::filesystem::path folder;

  std::filesystem::path gentle() const { return folder / "gentle"; }
  std::filesystem::path recording(const DemoScene& scene) const { return folder / scene.name; }
  std::filesystem::path calibrated_map() const { return folder / "map.yaml"; }
  /// In the truth's frame, to compare trajectories.
  std::filesystem::path aligned_map() const { return folder / "map_aligned.yaml"; }
  std::filesystem::path trajectory(const DemoScene& scene, const std::string& method) const;
  std::filesystem::path frame_log(const DemoScene& scene, const std::string& method) const;
  std::filesystem::path video(const DemoScene& scene) const;
  /// A picture of the report.
  std::filesystem::path picture(const std::string& name) const { return folder / (name + ".png"); }
  std::filesystem::path report() const { return folder / "report.html"; }
};

struct DemoStep {
  std::string what;
  std::vector<std::string> words;  ///< As a user would type them.
};

/// From nothing to trajectories, in the order to run them.
std::vector<DemoStep> demo_steps(const DemoOptions& options);

}  // namespace apriltrack::app
