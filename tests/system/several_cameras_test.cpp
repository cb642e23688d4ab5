// Several cameras, and several recordings of one: whose lens, and whose clock.

#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "apriltrack/detect/detections_csv.h"
#include "apriltrack/eval/trajectory.h"
#include "filmed_wall.h"
#include "program.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;
using Words = std::vector<std::string>;

constexpr const char* kSamePlace = "  T_cn_cnm1: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n";
constexpr long long kPeriod_ns = 100'000'000;

class SeveralCameras : public ::testing::Test {
 protected:
  void SetUp() override { folder_ = temporary_folder(); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  static ProgramRun run(Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words);
  }

  fs::path folder_;
};

// ---- Whose lens

class LensOfDetections : public SeveralCameras {
 protected:
  static constexpr double kFocal0_px = 300.0;
  static constexpr double kFocal1_px = 500.0;

  /// Rows of cam1 only, and cameras that are mistaken for each other at a price.
  void SetUp() override {
    SeveralCameras::SetUp();
    std::string rows = kDetectionsHeader;
    for (int view = 0; view < 10; ++view) {
      for (const int id : {0, 1, 2})
        rows += wall_row(kPeriod_ns * view, camera_from_wall(view), id, "cam1", kFocal1_px);
    }
    write_text(path("d.csv"), rows);
    write_text(path("rig.yaml"),
               pinhole_entry("cam0", kFocal0_px) + pinhole_entry("cam1", kFocal1_px) + kSamePlace);
    write_text(path("single.yaml"), pinhole_entry("cam0", kFocal1_px));
    run_for_json({"calibrate", "--detections", path("d.csv"), "--camera", path("single.yaml"), "--tag-size",
                  "0.16", "--output", path("map.yaml")});
    expect_distances_of_wall(read_tag_map(path("map.yaml")));
  }

  Words track(const std::string& camera) const {
    return {"track",          "--detections", path("d.csv"),   "--camera",     path(camera),      "--map",
            path("map.yaml"), "--output",     path("out.tum"), "--frames-csv", path("frames.csv")};
  }

  /// Distances between poses do not depend on where the map has its origin.
  void expect_exact_path() const {
    const Trajectory poses = read_tum(path("out.tum"));
    ASSERT_EQ(poses.size(), 10U);
    for (int view = 1; view < 10; ++view) {
      const Eigen::Vector3d step_m = poses[view].pose.translation() - poses[0].pose.translation();
      const Eigen::Vector3d true_step_m =
          camera_from_wall(view).inverse().translation() - camera_from_wall(0).inverse().translation();
      EXPECT_NEAR(step_m.norm(), true_step_m.norm(), 1e-3) << view;
    }
  }
};

TEST_F(LensOfDetections, AnotherNameIsRefusedWhereTheCameraFileHasSeveral) {
  const ProgramRun wrong = run_program(track("rig.yaml"));
  EXPECT_THAT(wrong, EndsWith(2, "d.csv: has no detections of camera 'cam0'; it has: cam1"));
  EXPECT_THAT(wrong, EndsWith(2, "--camera-name"));
  EXPECT_FALSE(fs::exists(path("out.tum")));
  EXPECT_EQ(run(track("rig.yaml"), {"--camera-name", "cam1"}).status, 0);
  expect_exact_path();
}

TEST_F(LensOfDetections, AnotherNameIsTakenWhereTheCameraFileHasOne) {
  EXPECT_EQ(run_program(track("single.yaml")).status, 0);
  expect_exact_path();
}

class OwnCameraFiles : public SeveralCameras {
 protected:
  /// A sequence folder with one blank image: past the camera file, calibrate ends with status 1.
  void write_sequence(const std::string& name, const std::string& camera) const {
    write_text(path(name) + "/frames/1000000000.pgm", "P5\n640 480\n255\n" + std::string(640 * 480, '\x80'));
    write_text(path(name) + "/camera.yaml", camera);
  }
  ProgramRun calibrate(const Words& inputs) const {
    return run({"calibrate", "--tag-size", "0.16", "--output", path("map.yaml")}, inputs);
  }
};

TEST_F(OwnCameraFiles, ThatDifferAreRefusedByName) {
  write_sequence("a", pinhole_entry("cam0", 500.0));
  write_sequence("b", pinhole_entry("cam0", 501.0));
  const std::string differ =
      "--camera: is required: '" + path("a") + "/camera.yaml' and '" + path("b") + "/camera.yaml' differ";
  EXPECT_THAT(calibrate({path("a"), path("b")}), EndsWith(2, differ));
  EXPECT_THAT(calibrate({"cam0=" + path("a"), "cam0=" + path("b")}), EndsWith(2, differ));
  EXPECT_THAT(calibrate({path("a"), path("b"), "--camera", path("a") + "/camera.yaml"}),
              EndsWith(1, "no tags were seen in 2 frames"));
  for (const std::string& other :
       {pinhole_entry("cam0", 500.0) + "  line_delay: 1.0e-5\n",
        pinhole_entry("cam0", 500.0) + "  response: linear\n",
        pinhole_entry("cam0", 500.0) + pinhole_entry("cam1", 500.0) + kSamePlace}) {
    write_sequence("b", other);
    EXPECT_THAT(calibrate({path("a"), path("b")}), EndsWith(2, differ)) << other;
  }
}

TEST_F(OwnCameraFiles, AreNotLentToOtherInputs) {
  write_sequence("a", pinhole_entry("cam0"));
  write_sequence("b", pinhole_entry("cam0"));
  fs::remove(path("b") + "/camera.yaml");
  for (const std::string& other : {path("b"), path("a") + "/frames"}) {  // one is a folder of images
    const std::string asked =
        "--camera: is required: '" + other + "' is no sequence folder with a camera.yaml";
    EXPECT_THAT(calibrate({path("a"), other}), EndsWith(2, asked));
    EXPECT_THAT(calibrate({other, path("a")}), EndsWith(2, asked));
    EXPECT_THAT(calibrate({path("a"), other, "--camera", path("a") + "/camera.yaml"}),
                EndsWith(1, "no tags"));
  }
}

TEST_F(OwnCameraFiles, ThatSayTheSameAreTaken) {
  write_sequence("a", pinhole_entry("cam0") + "  exposure_time: 0.003\n");
  write_sequence("b", "# made later\n" + pinhole_entry("cam0") + "  exposure_time: 0.016\n");
  EXPECT_THAT(calibrate({path("a"), path("b")}), EndsWith(1, "no tags were seen in 2 frames"));
}

TEST_F(OwnCameraFiles, AreFoundInAFolderWithAnEqualsSign) {
  write_sequence("run=3", pinhole_entry("cam0"));
  EXPECT_THAT(calibrate({path("run=3")}), EndsWith(1, "no tags were seen in 1 frames"));
  EXPECT_THAT(calibrate({"cam0=" + path("run=3")}), EndsWith(1, "no tags were seen in 1 frames"));
}

// ---- Whose clock

/// Camera cam0 made two recordings, each from time zero, and cam1, at the same place, one that goes on while
/// the second one of cam0 would follow its first. Moments of different recordings of cam0 must never be one.
class SeveralTakes : public SeveralCameras {
 protected:
  void SetUp() override {
    SeveralCameras::SetUp();
    write_text(path("rig.yaml"), pinhole_entry("cam0") + pinhole_entry("cam1") + kSamePlace);
  }

  void film_wall(const std::string& file, const std::string& camera, int first_view, int num_views) const {
    std::string rows = kDetectionsHeader;
    for (int i = 0; i < num_views; ++i) {
      for (const int id : {0, 1, 2})
        rows += wall_row(kPeriod_ns * i, camera_from_wall(first_view + i), id, camera);
    }
    write_text(path(file), rows);
  }

  /// end_ns: of cam1's recording. num_later: how many frames the second recording of cam0 has.
  void expect_second_take_behind(const std::string& observations, long long end_ns, int num_later) const {
    int later = 0;
    for (const FrameDetections& frame : read_detections_csv(path(observations))) {
      EXPECT_TRUE(frame.camera == "cam0" || frame.timestamp.ns <= end_ns) << frame.timestamp.ns;
      if (frame.timestamp.ns > end_ns) ++later;
    }
    EXPECT_EQ(later, num_later) << observations;
  }
};

TEST_F(SeveralTakes, OfDetectionsAreKeptApartInAnyOrderOfTheArguments) {
  film_wall("a0.csv", "cam0", 0, 10);
  film_wall("a1.csv", "cam0", 40, 10);
  film_wall("b0.csv", "cam1", 0, 30);
  const std::map<std::string, Words> orders = {{"last", {"a0.csv", "a1.csv", "b0.csv"}},
                                               {"first", {"b0.csv", "a0.csv", "a1.csv"}},
                                               {"between", {"a0.csv", "b0.csv", "a1.csv"}}};
  for (const auto& [name, files] : orders) {
    Words words = {"calibrate", "--camera", path("rig.yaml"),    "--tag-size",
                   "0.16",      "--output", path(name + ".yaml")};
    for (const std::string& file : files) words.insert(words.end(), {"--detections", path(file)});
    run_for_json(words);
    expect_distances_of_wall(read_tag_map(path(name + ".yaml")));
    expect_second_take_behind(name + ".detections.csv", 29 * kPeriod_ns, 10);
  }
  for (const std::string name : {"last", "between"})
    EXPECT_EQ(read_text(path(name + ".detections.csv")), read_text(path("first.detections.csv"))) << name;
}

TEST_F(SeveralTakes, OfImagesAreKeptApartInAnyOrderOfTheArguments) {
  constexpr int kFrames = 12;
  run_for_json(
      {"simulate", "--scene", "room-gentle", "--frames", std::to_string(kFrames), "--output", path("room")});
  std::set<fs::path> images;
  for (const auto& entry : fs::directory_iterator(path("room") + "/frames")) images.insert(entry.path());
  const std::vector<fs::path> frames(images.begin(), images.end());
  const auto copy = [&](const std::string& folder, int i, const fs::path& image) {
    fs::create_directories(path(folder));
    fs::copy(image, path(folder) + "/image" + std::to_string(i) + ".png");
  };
  for (int i = 0; i < kFrames; ++i) copy("b0", i, frames[i]);
  for (int i = 0; i < 8; ++i) copy("a0", i, frames[i]);
  for (int i = 0; i < 6; ++i) copy("a1", i, frames[kFrames - 1 - i]);  // backwards

  const std::string camera = read_text(path("room") + "/camera.yaml");
  write_text(path("rig.yaml"), camera + "\ncam1" + camera.substr(4) + "\n" + kSamePlace);
  const Words words = {"calibrate", "--camera", path("rig.yaml"), "--tag-size", "0.16", "--rate", "1"};
  const Words a = {"cam0=" + path("a0"), "cam0=" + path("a1")};
  const std::string b = "cam1=" + path("b0");
  EXPECT_EQ(run(words, {"--output", path("last.yaml"), a[0], a[1], b}).status, 0);
  EXPECT_EQ(run(words, {"--output", path("first.yaml"), b, a[0], a[1]}).status, 0);
  for (const std::string name : {"last", "first"})
    expect_second_take_behind(name + ".detections.csv", (kFrames - 1) * 1'000'000'000LL, 6);
  EXPECT_EQ(read_text(path("last.detections.csv")), read_text(path("first.detections.csv")));
}

}  // namespace
}  // namespace apriltrack::test
