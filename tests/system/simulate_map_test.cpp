#include <gmock/gmock.h>

#include <filesystem>

#include "apriltrack/camera/camera.h"
#include "apriltrack/eval/trajectory.h"
#include "apriltrack/geometry/rotation.h"
#include "apriltrack/sim/named_scenes.h"
#include "apriltrack/tags/tag_map.h"
#include "program.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::Contains;
using testing::HasSubstr;

/// Files as users bring them: a map, a camera and a path. The path's poses are far apart, the frames between
/// them.
class SimulateMap : public testing::Test {
 protected:
  void SetUp() override {
    const Scene room = make_scene("room-gentle", {.texel_m = 0.05});
    map_ = room.map;
    camera_ = room.camera;
    camera_.exposure_s = 0.004;
    for (int i = 0; i < 6; ++i) {
      const Timestamp time = {1'600'000'000'000'000'000 + 200'000'000LL * i};
      path_.push_back({time, room.T_world_camera.at(0.2 * i)});
    }
    write_tag_map(file("map.yaml"), map_);
    write_cameras(file("camera.yaml"), {{camera_}});
    write_tum(file("path.tum"), path_);
  }

  std::string file(const std::string& name) const { return (folder_ / name).string(); }
  std::vector<std::string> words(std::vector<std::string> further) const {
    std::vector<std::string> all = {"simulate",          "--map",        file("map.yaml"), "--camera",
                                    file("camera.yaml"), "--trajectory", file("path.tum"), "--output",
                                    file("film")};
    all.insert(all.end(), further.begin(), further.end());
    return all;
  }

  fs::path folder_ = temporary_folder();
  TagMap map_;
  Camera camera_{.model = CameraModel(Pinhole{1, 1, 0, 0}, NoDistortion{})};
  Trajectory path_;
};

TEST_F(SimulateMap, FilmsTheUsersTagsByTheUsersLensAlongTheUsersPath) {
  const json summary = run_for_json(words({"--rate", "10", "--seed", "4"}));
  EXPECT_EQ(summary.at("frames"), 10);  // (1 s - 4 ms) at 10 Hz, and the first
  EXPECT_EQ(summary.at("frames_with_tags"), 10);
  EXPECT_EQ(summary.at("tags"), 14);
  EXPECT_THAT(summary.at("tags_never_in_view"), Contains("tag36h11/12"));
  const Camera written = read_cameras(file("film/camera.yaml")).cameras.front();
  EXPECT_EQ(written.exposure_s, 0.004);

  run_for_json({"track", file("film"), "--method", "pnp", "--output", file("found.tum")});
  const Trajectory found = read_tum(file("found.tum"));
  ASSERT_EQ(found.size(), 10u);
  int num_compared = 0;
  for (const TimedPose& pose : found) {
    // The user's pose k is at 0.2 k s of the film; frames are at 2 ms + 0.1 s i, 2 ms after it: far below the
    // limits.
    const double at_s = seconds_between({2'000'000}, pose.timestamp) / 0.2;
    const auto k = static_cast<std::size_t>(std::lround(at_s));
    if (std::abs(at_s - static_cast<double>(k)) > 0.01 || k >= path_.size()) continue;
    const Pose error = path_[k].pose.inverse() * pose.pose;
    EXPECT_LT(error.translation().norm(), 0.005);  // m; moves at 0.3 m/s
    EXPECT_LT(rotation_log(error.rotation()).norm(), 0.005);
    ++num_compared;
  }
  EXPECT_EQ(num_compared, 5);
}

TEST_F(SimulateMap, SaysWhatIsMissingAndWhatDoesNotGoTogether) {
  EXPECT_THAT(
      run_program({"simulate", "--map", file("map.yaml"), "--output", file("film")}),
      EndsWith(
          2, "--camera: is missing: one's own tags are filmed by --map, --camera and --trajectory together"));
  EXPECT_THAT(run_program({"simulate", "--output", file("film")}),
              EndsWith(2, "--scene: is missing: name a scene"));
  EXPECT_THAT(run_program(words({"--scene", "room"})),
              EndsWith(2, "--scene: films its own tags by its own camera"));
  EXPECT_THAT(run_program(words({"--take", "3"})), EndsWith(2, "--take: shakes the path of a named scene"));
  EXPECT_THAT(run_program(words({"--frames", "90"})),
              EndsWith(2, "--frames: must be at most 5, as the trajectory holds"));
  EXPECT_FALSE(fs::exists(file("film")));
}

TEST_F(SimulateMap, TakesLayoutsThatStateNoSize) {
  run_for_json({"map", "convert", file("map.yaml"), file("field.json"), "--to", "wpilib"});
  std::vector<std::string> wanted = words({"--frames", "1", "--tag-size", "0.16", "--family", "tag36h11"});
  wanted[2] = file("field.json");
  EXPECT_EQ(run_for_json(wanted).at("frames_with_tags"), 1);
  EXPECT_EQ(read_tag_map(file("film/map.yaml")).tags.front().size_m, 0.16);
  EXPECT_THAT(run_program({"simulate", "--scene", "room", "--tag-size", "0.1", "--output", file("other")}),
              EndsWith(2, "--map"));
}

TEST_F(SimulateMap, AsksWhyNoTagIsEverInView) {
  // 100 m above the room, looking up.
  for (TimedPose& pose : path_) pose.pose = Pose(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0, 0, 100));
  write_tum(file("path.tum"), path_);
  const json summary = run_for_json(words({"--frames", "2"}));
  ASSERT_EQ(summary.at("frames_with_tags"), 0) << "the test is of a path that sees none";
  EXPECT_THAT(summary.at("warnings").at(0).get<std::string>(), HasSubstr("not its inverse"));
}

TEST_F(SimulateMap, TellsOfGapsAndOfARollingShutter) {
  camera_.line_delay_s = 3e-5;
  write_cameras(file("camera.yaml"), {{camera_}});
  path_.push_back({{path_.back().timestamp.ns + 2'000'000'000}, path_.back().pose});
  write_tum(file("path.tum"), path_);
  const ProgramRun run = run_program(words({"--frames", "1"}));
  EXPECT_EQ(run.status, 0);
  EXPECT_THAT(run.err, HasSubstr("rolling shutters are not rendered"));
  EXPECT_THAT(run.err, HasSubstr("the longest step from pose to pose is 2 s, the median 0.2 s"));
  EXPECT_EQ(read_cameras(file("film/camera.yaml")).cameras.front().line_delay_s, 0.0);
}

TEST_F(SimulateMap, RefusesACameraWithoutResolutionAndALonePose) {
  write_text(
      file("wpilib.json"),
      R"({"camera_matrix": [500, 0, 320, 0, 500, 240, 0, 0, 1], "distortion_coefficients": [0, 0, 0, 0]})");
  EXPECT_THAT(run_program({"simulate", "--map", file("map.yaml"), "--camera", file("wpilib.json"),
                           "--trajectory", file("path.tum"), "--output", file("film")}),
              EndsWith(2, "does not state the resolution"));
  path_.resize(1);
  write_tum(file("path.tum"), path_);
  EXPECT_THAT(run_program(words({})), EndsWith(2, "a path needs two poses or more (has 1)"));
}

}  // namespace
}  // namespace apriltrack::test
