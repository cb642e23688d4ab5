// Ctrl-C once all pictures are read: the map that is not there yet is given up, the one that is there is
// kept.

#include <gmock/gmock.h>

#include <chrono>
#include <filesystem>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detections_csv.h"
#include "apriltrack/tags/tag_map.h"
#include "program.h"
#include "support/shared_data.h"
#include "synthetic_world.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::Pair;

/// Ctrl-C as soon as `line` is told.
ProgramRun interrupt_at(const std::string& line, const std::vector<std::string>& words) {
  StartedProgram program(words);
  while (program.is_running() && program.err_so_far().find(line) == std::string::npos)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_THAT(program.err_so_far(), HasSubstr(line));
  program.press_ctrl_c();
  return program.finish();
}

/// Tags of another size than stated: what is wrong with each is tried for many seconds.
std::vector<FrameDetections> hard_views(const SyntheticWorld& world) {
  SyntheticWorld printed = world;
  for (std::size_t i = 0; i < printed.map.tags.size(); i += 5) printed.map.tags[i].size_m *= 1.1;
  std::vector<FrameDetections> frames = exact_detections(printed);
  RandomStream random(20261);
  add_edge_noise(frames, 0.1, -0.45, random);
  return frames;
}

TEST(InterruptedSolve, Is1AndLeavesTheOldFiles) {
  const fs::path folder = temporary_folder();
  const SyntheticWorld world = make_room(20, 1000, perspective_camera());
  write_detections_csv(folder / "hard.csv", hard_views(world));
  write_cameras(folder / "camera.yaml", world.rig);
  for (const char* name : {"map.yaml", "map.detections.csv", "page.html"})
    write_text(folder / "out" / name, "old\n");
  const ProgramRun run =
      interrupt_at("adjusting 20 tags",
                   {"calibrate", "--detections", folder / "hard.csv", "--camera", folder / "camera.yaml",
                    "--tag-size", std::to_string(world.map.tags.front().size_m), "--output",
                    folder / "out" / "map.yaml", "--report", folder / "out" / "page.html", "--json"});
  EXPECT_THAT(run, EndsWith(1, "error: calibrate: interrupted while the map was solved: no map was written"));
  EXPECT_EQ(nlohmann::json::parse(run.out)["error"]["kind"], "no_result");
  EXPECT_EQ(names_in(folder / "out"), (std::set<std::string>{"map.detections.csv", "map.yaml", "page.html"}));
  for (const std::string& name : names_in(folder / "out"))
    EXPECT_EQ(read_text(folder / "out" / name), "old\n") << name;
}

TEST(InterruptedSolve, KeepsTheMapOfTheCornersWhileItIsRefined) {
  const fs::path folder = temporary_folder();
  const fs::path recording = folder / "room", map = folder / "map.yaml";
  run_for_json(
      {"simulate", "--scene", "room-gentle", "--frames", "40", "--seed", "3", "--output", recording});
  const ProgramRun run = interrupt_at("refining", {"calibrate", recording, "--tag-size", "0.16", "--output",
                                                   map, "--threads", "1", "--json"});
  EXPECT_THAT(run, EndsWith(0, "warning: interrupted: the map is as the corners have it"));
  EXPECT_THAT(run.err, Not(HasSubstr("frames until then")));
  const nlohmann::json told = nlohmann::json::parse(run.out);
  EXPECT_EQ(told["interrupted"], true);
  EXPECT_EQ(told["frames"], 40);
  EXPECT_EQ(told["refinement"]["accepted"], false);
  const TagMap written = read_tag_map(map);
  EXPECT_EQ(written.tags.size(), told["tags"].size());
  EXPECT_THAT(written.provenance, Contains(Pair("refinement", "none: interrupted")));
}

}  // namespace
}  // namespace apriltrack::test
