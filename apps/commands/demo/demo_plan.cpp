#include "demo_plan.h"

#include <fmt/format.h>

namespace apriltrack::app {
namespace {

/// The options that every step takes.
class Steps {
 public:
  explicit Steps(const DemoOptions& options) : options_(options) {}

  void add(std::string what, std::vector<std::string> words) {
    steps_.push_back({std::move(what), std::move(words)});
  }
  void add_threaded(std::string what, std::vector<std::string> words) {
    words.insert(words.end(), {"--threads", std::to_string(options_.threads)});
    add(std::move(what), std::move(words));
  }
  void add_seeded(std::string what, std::vector<std::string> words) {
    words.insert(words.end(), {"--seed", std::to_string(options_.seed)});
    add_threaded(std::move(what), std::move(words));
  }
  std::vector<DemoStep> take() { return std::move(steps_); }

 private:
  const DemoOptions& options_;
  std::vector<DemoStep> steps_;
};

void add_calibration(Steps& steps, const DemoFiles& files) {
  const std::string gentle = files.gentle().string();
  const std::string true_map = (files.gentle() / "map.yaml").string();
  steps.add_seeded("A gentle recording of a room of tags, to calibrate from",
                   {"simulate", "--scene", "room-gentle", "--frames", "150", "--speed", "2", "--exposure",
                    "0.003", "--output", gentle, "--force"});
  steps.add_threaded(
      "Where are the tags? A map from the gentle recording's images",
      {"calibrate", gentle, "--tag-size", "0.16", "--output", files.calibrated_map().string()});
  steps.add("The map against the truth", {"map", "diff", true_map, files.calibrated_map().string()});
  steps.add(
      "The map into the truth's frame, to compare trajectories",
      {"map", "align", true_map, files.calibrated_map().string(), "--output", files.aligned_map().string()});
}

const char* question(const std::string& method) {
  if (method == "pnp") return "by detection alone, as robots do today";
  if (method == "paper") return "by the seed paper's particle filter";
  return "through the blur";
}

void add_tracking(Steps& steps, const DemoOptions& options, const DemoFiles& files, const DemoScene& scene) {
  const bool is_ego = scene.mode == TrackMode::kEgo;
  const std::string recording = files.recording(scene).string();
  steps.add_seeded(scene.story, {"simulate", "--scene", scene.name, "--frames",
                                 std::to_string(options.num_frames / scene.num_parts), "--speed", scene.speed,
                                 "--output", recording, "--force"});
  for (const std::string method : kDemoMethods) {
    std::vector<std::string> words = {"track",    recording, "--mode", is_ego ? "ego" : "joint",
                                      "--method", method};
    if (is_ego) words.insert(words.end(), {"--map", files.aligned_map().string()});
    words.insert(words.end(), {"--output", files.trajectory(scene, method).string(), "--frames-csv",
                               files.frame_log(scene, method).string()});
    if (method == "blur") words.insert(words.end(), {"--video", files.video(scene).string()});
    if (method == "pnp") {
      steps.add_threaded(fmt::format("{}: {}", scene.name, question(method)), std::move(words));
    } else {
      steps.add_seeded(fmt::format("{}: {}", scene.name, question(method)), std::move(words));
    }
  }
}

}  // namespace

std::filesystem::path DemoFiles::trajectory(const DemoScene& scene, const std::string& method) const {
  return folder / fmt::format("{}_{}.tum", scene.name, method);
}

std::filesystem::path DemoFiles::frame_log(const DemoScene& scene, const std::string& method) const {
  return folder / fmt::format("{}_{}_frames.csv", scene.name, method);
}

std::filesystem::path DemoFiles::video(const DemoScene& scene) const {
  return folder / fmt::format("{}_blur.mp4", scene.name);
}

std::vector<DemoStep> demo_steps(const DemoOptions& options) {
  const DemoFiles files{options.output};
  Steps steps(options);
  add_calibration(steps, files);
  for (const DemoScene& scene : kDemoScenes) add_tracking(steps, options, files, scene);
  return steps.take();
}

}  // namespace apriltrack::app
