// A EuRoC recording of two cameras: whose pictures a command reads.

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detections_csv.h"
#include "apriltrack/source/sequence_writer.h"
#include "program.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;

class EurocCameras : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = temporary_folder();
    write_text(recording() + "/imu0/data.csv", "#timestamp [ns],w_RS_S_x [rad s^-1]\n");
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string recording() const { return path("mav0"); }

  void simulate(const std::string& scene, int frames) const {
    run_for_json({"simulate", "--scene", scene, "--frames", std::to_string(frames), "--exposure", "0.0005",
                  "--output", path(scene)});
  }

  /// The pictures of a simulated scene as `camera`'s, delay_ns later than they were rendered.
  void give(const std::string& scene, const std::string& camera, std::int64_t delay_ns = 0) const {
    std::set<std::int64_t> times_ns;
    const fs::path data = recording() + "/" + camera + "/data";
    fs::create_directories(data);
    for (const auto& image : fs::directory_iterator(path(scene) + "/frames")) {
      times_ns.insert(std::stoll(image.path().stem()));
      fs::copy(image.path(), data);
    }
    std::string table = "#timestamp [ns],filename\n";
    for (const std::int64_t time_ns : times_ns)
      table += std::to_string(time_ns + delay_ns) + "," + sequence_frame_name({time_ns}) + "\n";
    write_text(data.parent_path() / "data.csv", table);
  }

  /// Camera files of two scenes as one rig's, whose cameras are at one place.
  void write_rig(const std::string& scene0, const std::string& scene1) const {
    const std::string second = read_text(path(scene1) + "/camera.yaml").substr(4);
    write_text(path("rig.yaml"), read_text(path(scene0) + "/camera.yaml") + "\ncam1" + second +
                                     "\n  T_cn_cnm1: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], "
                                     "[0, 0, 0, 1]]\n");
  }

  fs::path folder_;
};

/// Of the tags that `camera` saw.
std::set<int> ids_seen(const std::string& file, const std::string& camera) {
  std::set<int> ids;
  for (const FrameDetections& frame : read_detections_csv(file)) {
    for (const Detection& detection : frame.detections)
      if (frame.camera == camera) ids.insert(detection.tag.id);
  }
  return ids;
}

// Before cam0 is the cube of `bundle`, tags 20 to 25; before cam1, which is larger, tag 5 of `single`.
TEST_F(EurocCameras, TheOneThatIsNamedIsLookedAt) {
  simulate("bundle", 3);
  simulate("single", 3);
  give("bundle", "cam0");
  give("single", "cam1");
  run_for_json({"detect", recording(), "--camera-name", "cam1", "--output", path("d.csv")});
  EXPECT_EQ(ids_seen(path("d.csv"), "cam1"), (std::set<int>{5}));
  run_for_json({"detect", recording(), "--output", path("d.csv")});
  EXPECT_GE(ids_seen(path("d.csv"), "cam0").size(), 2U);
  EXPECT_FALSE(ids_seen(path("d.csv"), "cam0").contains(5));

  write_rig("bundle", "single");
  run_for_json({"track", recording(), "--mode", "joint", "--camera", path("rig.yaml"), "--camera-name",
                "cam1", "--map", path("single/map.yaml"), "--output", path("out.tum")});
  const nlohmann::json score =
      run_for_json({"evaluate", "--truth", path("single"), "--estimate", path("out.tum"), "--mode", "joint"});
  EXPECT_EQ(score["success_5px"], 1.0) << score.dump(1);
}

/// As EuRoC has it: no name, no exposure, no response.
std::string sensor_yaml(const std::string& camera_yaml) {
  const Camera camera = read_cameras(camera_yaml).cameras.front();
  const Pinhole& p = camera.model.pinhole();
  const std::vector<double> d =
      std::visit([](const auto& lens) { return lens.coefficients(); }, camera.model.distortion());
  return fmt::format(
      "sensor_type: camera\ncomment: x\nT_BS:\n  cols: 4\n  rows: 4\n"
      "  data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\nrate_hz: 20\n"
      "resolution: [{}, {}]\ncamera_model: pinhole\nintrinsics: [{}, {}, {}, {}]\n"
      "distortion_model: radial-tangential\ndistortion_coefficients: [{}]\n",
      camera.width, camera.height, p.fx, p.fy, p.cx, p.cy, fmt::join(d, ", "));
}

// cam0 is said to have another lens, and cam1 the right one.
TEST_F(EurocCameras, BringTheirCamerasThemselves) {
  simulate("room-gentle", 12);
  give("room-gentle", "cam0");
  give("room-gentle", "cam1");
  const std::string film = path("room-gentle");
  write_text(path("sensor.yaml"), sensor_yaml(film + "/camera.yaml"));
  write_text(recording() + "/cam1/sensor.yaml", read_text(path("sensor.yaml")));
  std::string other = read_text(path("sensor.yaml"));
  const std::size_t at = other.find("intrinsics: [") + 13;
  other.insert(at, "1");
  write_text(recording() + "/cam0/sensor.yaml", other);
  const std::vector<std::string> track = {"track", recording(), "--map", film + "/map.yaml", "--output"};
  const auto tracked = [&](const std::string& name, std::vector<std::string> more) {
    std::vector<std::string> words = track;
    words.push_back(path(name));
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words);
  };
  const ProgramRun own = tracked("own.tum", {"--camera-name", "cam1"});
  ASSERT_EQ(own.status, 0) << own.err;
  EXPECT_NE(own.err.find("mav0/cam1/sensor.yaml is the camera file of cam1"), std::string::npos) << own.err;
  ASSERT_EQ(tracked("given.tum", {"--camera", path("sensor.yaml")}).status, 0);
  EXPECT_EQ(read_text(path("own.tum")), read_text(path("given.tum")));
  EXPECT_NE(tracked("cam0.tum", {}).err.find("mav0/cam0/sensor.yaml is the camera file of cam0"),
            std::string::npos);

  run_for_json({"calibrate", recording(), "--camera-name", "cam1", "--tag-size", "0.16", "--output",
                path("map.yaml")});
  for (const FrameDetections& frame : read_detections_csv(path("map.detections.csv")))
    EXPECT_EQ(frame.camera, "cam1");
  run_for_json({"detect", recording(), "--camera-name", "cam1", "--output", path("d.csv")});
  EXPECT_GE(ids_seen(path("d.csv"), "cam1").size(), 2U);

  fs::remove(recording() + "/cam0/sensor.yaml");
  EXPECT_THAT(tracked("none.tum", {}), EndsWith(2, "no EuRoC recording with a sensor.yaml"));
}

TEST_F(EurocCameras, OneThatIsNotThereIsRefusedAndThoseThereAreNamed) {
  simulate("single", 1);
  give("single", "cam0");
  give("single", "cam1");
  EXPECT_THAT(run_program({"detect", recording(), "--camera-name", "imu0", "--output", path("d.csv")}),
              EndsWith(2, recording() + ": the recording has no camera 'imu0'; it has: cam0, cam1"));
}

// Both cameras have the same pictures, but cam1 took them ten seconds later.
TEST_F(EurocCameras, EachOfOneCalibrationReadsItsOwn) {
  simulate("room-gentle", 12);
  constexpr std::int64_t kDelay_ns = 10'000'000'000;
  give("room-gentle", "cam0");
  give("room-gentle", "cam1", kDelay_ns);
  write_rig("room-gentle", "room-gentle");
  run_for_json({"calibrate", "cam0=" + recording(), "cam1=" + recording(), "--camera", path("rig.yaml"),
                "--tag-size", "0.16", "--output", path("map.yaml")});
  int num_frames[2] = {0, 0};
  for (const FrameDetections& frame : read_detections_csv(path("map.detections.csv"))) {
    EXPECT_EQ(frame.camera, frame.timestamp.ns < kDelay_ns ? "cam0" : "cam1") << frame.timestamp.ns;
    ++num_frames[frame.camera == "cam0" ? 0 : 1];
  }
  EXPECT_GT(num_frames[0], 5);
  EXPECT_EQ(num_frames[0], num_frames[1]);
}

}  // namespace
}  // namespace apriltrack::test
