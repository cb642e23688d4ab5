// A camera that a calibration refined is written; also where its file tells no resolution.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "apriltrack/camera/camera.h"
#include "filmed_wall.h"
#include "program.h"
#include "support/shared_data.h"
#include "wpilib_camera.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

class RefinedCamera : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  /// The camera of the pictures with other focal lengths, in a file that tells no resolution.
  std::string without_resolution(const fs::path& camera, double focal_factor) const {
    const CameraModel model = read_cameras(camera).cameras.front().model;
    Pinhole lens = model.pinhole();
    lens.fx *= focal_factor;
    lens.fy *= focal_factor;
    write_text(path("camera.json"), wpilib_text(CameraModel(lens, model.distortion())));
    return path("camera.json");
  }

  std::vector<std::string> words(const std::vector<std::string>& more) const {
    std::vector<std::string> all = {"calibrate", "--tag-size", "0.16", "--output", path("map.yaml")};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }

  /// By a camera of 500 pixels of focal length, whose file says 520.
  std::vector<std::string> of_detections(const std::vector<std::string>& more) const {
    std::string csv = kDetectionsHeader;
    for (int view = 0; view < 40; ++view) {
      for (const int id : {0, 1, 2}) csv += wall_row(100'000'000LL * view, camera_from_wall(view), id);
    }
    write_text(path("corners.csv"), csv);
    write_text(path("camera.yaml"), pinhole_entry("cam0"));
    const std::string camera = without_resolution(path("camera.yaml"), 1.04);
    std::vector<std::string> all = words({"--detections", path("corners.csv"), "--camera", camera});
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }

  const fs::path folder_ = temporary_folder();
};

TEST_F(RefinedCamera, HasTheResolutionOfTheImagesWhereItsFileTellsNone) {
  run_for_json({"simulate", "--scene", "room-gentle", "--frames", "60", "--rate", "8", "--speed", "2",
                "--exposure", "0.003", "--output", path("room")});
  const std::string camera = without_resolution(path("room/camera.yaml"), 1.04);
  const nlohmann::json summary =
      run_for_json(words({path("room"), "--camera", camera, "--intrinsics", "refine"}));
  ASSERT_EQ(summary["camera"], path("map.camera.yaml")) << "it does refine";
  const Camera written = read_cameras(path("map.camera.yaml")).cameras.front();
  const Camera truth = read_cameras(path("room/camera.yaml")).cameras.front();
  EXPECT_EQ(written.width, truth.width);
  EXPECT_EQ(written.height, truth.height);
  EXPECT_NEAR(written.model.pinhole().fx / truth.model.pinhole().fx, 1.0, 0.01);  // it says 0.005 itself
}

TEST_F(RefinedCamera, HasItsResponseTableBesideItByTheNameOfTheMap) {
  std::vector<std::string> all = of_detections({"--intrinsics", "refine"});
  std::string table;
  for (int i = 0; i < 256; ++i) table += std::to_string(i * i / 65025.0) + "\n";
  write_text(path("light.txt"), table);
  write_text(path("camera.yaml"), pinhole_entry("cam0", 520.0) + "  response: light.txt\n");
  std::ranges::replace(all, path("camera.json"), path("camera.yaml"));
  const auto names_of_tables = [&] {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      const std::string name = entry.path().filename().string();
      if (name.find("response") != std::string::npos) names.push_back(name);
    }
    return names;
  };
  // The page is the first file that does not fit: the table is written before it.
  all.insert(all.end(), {"--report", path("page.html")});
  EXPECT_THAT(run_program_on_full_disk(all, 60'000), EndsWith(3, path("page.html")));
  EXPECT_THAT(names_of_tables(), ::testing::IsEmpty());
  ASSERT_EQ(run_program(all).status, 0);
  EXPECT_THAT(names_of_tables(), ::testing::ElementsAre("map.camera_cam0_response.txt"));
  EXPECT_EQ(read_cameras(path("map.camera.yaml")).cameras[0].response.linear_light(),
            read_cameras(path("camera.yaml")).cameras[0].response.linear_light());
}

TEST_F(RefinedCamera, IsRefusedBeforeTheWorkWhereNothingTellsItsResolution) {
  EXPECT_THAT(run_program(of_detections({"--intrinsics", "refine"})),
              AllOf(EndsWith(2, path("camera.json") + ": 'resolution' of cam0 is missing"),
                    EndsWith(2, "--intrinsics keep")));
  EXPECT_FALSE(fs::exists(path("map.yaml")));
}

TEST_F(RefinedCamera, IsNotMadeUnaskedWhereNothingTellsItsResolution) {
  const ProgramRun run = run_program(of_detections({}));
  EXPECT_THAT(run, EndsWith(0, "so the intrinsics stay as they are"));
  EXPECT_THAT(run.err, HasSubstr("with other intrinsics")) << "that they are wrong is told";
  EXPECT_TRUE(fs::exists(path("map.yaml")));
  EXPECT_FALSE(fs::exists(path("map.camera.yaml")));
}

TEST_F(RefinedCamera, IsWarnedOfWhereItHasNoPlaceBesideTheMap) {
  fs::create_symlink("/dev/null", path("map.yaml"));
  std::vector<std::string> all = of_detections({"--intrinsics", "refine"});
  write_text(path("camera.yaml"), pinhole_entry("cam0", 520.0));
  std::ranges::replace(all, path("camera.json"), path("camera.yaml"));
  EXPECT_THAT(run_program(all),
              EndsWith(0, "a camera that this run refined or estimated, which is not written: " +
                              path("map.yaml") + " is no file"));
  EXPECT_FALSE(fs::exists(path("map.camera.yaml")));
}

}  // namespace
}  // namespace apriltrack::test
