// `camera convert` and `camera show` as their users meet them.

#include <gtest/gtest.h>

#include <filesystem>

#include "program.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

class CameraConvert : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = temporary_folder();
    write_text(path("rig.yaml"), R"(cam0:
  label: front
  camera_model: pinhole
  intrinsics: [606.5, 608.75, 317.25, 255.5]
  distortion_model: radtan
  distortion_coeffs: [0.1, -0.2, 0.003, -0.004]
  resolution: [640, 480]
  exposure_time: 0.0125
  line_delay: 3e-5
  response: gamma:2.25
cam1:
  camera_model: pinhole
  intrinsics: [470.5, 460.25, 620.75, 534.5]
  distortion_model: equidistant
  distortion_coeffs: [-0.01, 0.02, -0.003, 0.0004]
  resolution: [1280, 1024]
  T_cn_cnm1: [[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]]
)");
    write_text(path("wpilib.json"), R"({"camera_matrix": [606.5, 0, 317.25, 0, 608.75, 255.5, 0, 0, 1],
      "distortion_coefficients": [0.1, -0.2, 0.003, -0.004, 0.05, 0.06, 0.07, 0.08], "avg_reprojection_error": 0.3})");
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  ProgramRun convert(const std::string& in, const std::string& out,
                     std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"camera", "convert", path(in), path(out)});
    return run_program(more);
  }
  bool is_there(const std::string& name) const { return std::filesystem::exists(path(name)); }

  std::filesystem::path folder_;
};

std::vector<std::string> kinds_of(const nlohmann::json& losses) {
  std::vector<std::string> kinds;
  for (const auto& loss : losses) kinds.push_back(loss["kind"]);
  return kinds;
}

TEST_F(CameraConvert, TellsWhatIsLostInWordsAndToMachines) {
  const ProgramRun run = convert("rig.yaml", "cameras.txt");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(
      run.err,
      HasSubstr(
          "not kept: camera 'front': its response, gamma:2.25 (no place for it in COLMAP cameras.txt)"));
  EXPECT_THAT(read_text(path("cameras.txt")),
              HasSubstr("\n1 OPENCV 640 480 606.5 608.75 317.75 256 0.1 -0.2 0.003 -0.004\n"
                        "2 OPENCV_FISHEYE 1280 1024 470.5 460.25 621.25 535 -0.01 0.02 -0.003 0.0004\n"));

  const nlohmann::json told = run_for_json({"camera", "convert", path("rig.yaml"), path("cameras.txt")});
  EXPECT_EQ(told["from"], "kalibr");
  EXPECT_EQ(told["to"], "colmap");
  EXPECT_THAT(kinds_of(told["losses"]),
              ElementsAre("response", "exposure", "line_delay", "names", "extrinsics"));
  EXPECT_EQ(told["warnings"].size(), 5U);
}

TEST_F(CameraConvert, OneCameraOfARig) {
  ASSERT_EQ(convert("rig.yaml", "right.yaml", {"--to", "ros", "--camera-name", "cam1"}).status, 0);
  const std::string text = read_text(path("right.yaml"));
  EXPECT_THAT(text, HasSubstr("distortion_model: equidistant"));
  EXPECT_THAT(text, HasSubstr("data: [470.5, 0, 620.75, 0, 460.25, 534.5, 0, 0, 1]"));
  EXPECT_THAT(convert("rig.yaml", "left.yaml", {"--camera-name", "left"}),
              EndsWith(2, path("rig.yaml") + ": there is no camera 'left'; the camera file has front, cam1"));
  EXPECT_FALSE(is_there("left.yaml"));
}

TEST_F(CameraConvert, AResolutionIsAskedForAndTaken) {
  EXPECT_THAT(convert("wpilib.json", "camera.yaml"), EndsWith(2, "--resolution WIDTHxHEIGHT"));
  EXPECT_FALSE(is_there("camera.yaml"));
  ASSERT_EQ(convert("wpilib.json", "camera.yaml", {"--resolution", "641x481"}).status, 0);
  EXPECT_THAT(read_text(path("camera.yaml")), HasSubstr("resolution: [641, 481]"));
  EXPECT_THAT(convert("rig.yaml", "c.txt", {"--resolution", "1280x1024"}),
              EndsWith(2, "--resolution: is 1280 x 1024, but the file says 640 x 480 for camera 'front'"));
  for (const char* wrong : {"640", "640x", "x480", "0x480", "640x480x3", "640*480", "-640x480", "1e3x480"})
    EXPECT_THAT(convert("wpilib.json", "c.yaml", {"--resolution", wrong}),
                EndsWith(2, "--resolution: must be WIDTHxHEIGHT"))
        << wrong;
}

TEST_F(CameraConvert, FormatsThatAreNoneOrAreNotWrittenAreNamedWithThoseThatAre) {
  EXPECT_THAT(convert("rig.yaml", "c.json"),
              EndsWith(2, "--to: is required: the ending of '" + path("c.json")));
  EXPECT_THAT(convert("rig.yaml", "c.json"),
              EndsWith(2, "wpilib (WPILib JSON), photonvision (PhotonVision JSON)"));
  EXPECT_THAT(convert("rig.yaml", "c.json", {"--to", "matlab"}),
              EndsWith(2, "--to: 'matlab' is no known format; there are kalibr"));
  EXPECT_THAT(convert("rig.yaml", "c.json", {"--to", "nerfstudio"}),
              EndsWith(2, "is a format that is read, not written"));
  EXPECT_FALSE(is_there("c.json"));
}

TEST_F(CameraConvert, AFisheyeIsRefusedByAFormatWithoutOneAndWhatIsThereStays) {
  write_text(path("c.json"), "of before");
  EXPECT_THAT(
      convert("rig.yaml", "c.json", {"--to", "wpilib", "--camera-name", "cam1"}),
      EndsWith(2, "'cam1' has the lens model equidistant (fisheye), which a WPILib JSON file cannot hold"));
  EXPECT_EQ(read_text(path("c.json")), "of before");
}

TEST_F(CameraConvert, OutIsNeverIn) {
  EXPECT_THAT(convert("rig.yaml", "rig.yaml", {"--to", "ros"}), EndsWith(2, "is an input of this run"));
  EXPECT_THAT(read_text(path("rig.yaml")), HasSubstr("label: front"));
}

/// Of 256 numbers, line by line.
std::string table_text(double scale) {
  std::string text;
  for (int i = 0; i < 256; ++i) text += std::to_string(scale * i * i / 65025.0) + "\n";
  return text;
}

TEST_F(CameraConvert, AResponseTableIsReplacedWithItsCameraOrNotAtAll) {
  const auto tabled = [&](const std::string& name, const std::string& table) {
    std::string text =
        "cam0: {camera_model: pinhole, intrinsics: [5, 6, 3, 2], distortion_model: none, "
        "resolution: [6, 4], response: " +
        table + "}\n";
    for (int i = 1; i < 30; ++i)  // so that the camera file is longer than the table
      text += "cam" + std::to_string(i) +
              ": {camera_model: pinhole, intrinsics: [5, 6, 3, 2], distortion_model: none, "
              "resolution: [6, 4]}\n";
    write_text(path(name), text);
  };
  write_text(path("old.txt"), table_text(0.5));
  write_text(path("new.txt"), table_text(0.75));
  tabled("old.yaml", "old.txt");
  tabled("new.yaml", "new.txt");
  ASSERT_EQ(convert("old.yaml", "lab #2.yaml").status, 0);
  const std::string table = path("lab #2_cam0_response.txt");
  const std::string camera_before = read_text(path("lab #2.yaml")), table_before = read_text(table);
  ASSERT_GT(camera_before.size(), table_before.size() + 500);
  EXPECT_THAT(run_program_on_full_disk({"camera", "convert", path("new.yaml"), path("lab #2.yaml")},
                                       table_before.size() + 250),
              EndsWith(3, path("lab #2.yaml") + ": cannot be written"));
  EXPECT_EQ(read_text(path("lab #2.yaml")), camera_before);
  EXPECT_EQ(read_text(table), table_before);
  ASSERT_EQ(convert("new.yaml", "lab #2.yaml").status, 0);
  EXPECT_NE(read_text(table), table_before);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 8) << "nothing else is left";
}

TEST_F(CameraConvert, AResponseTableIsNeverOneThatIsRead) {
  write_text(path("c_cam0_response.txt"), table_text(0.75));
  write_text(path("b.yaml"),
             R"(cam0: {camera_model: pinhole, intrinsics: [5, 6, 3, 2], distortion_model: none,
    resolution: [6, 4], response: c_cam0_response.txt})");
  EXPECT_THAT(convert("b.yaml", "c.yaml"),
              EndsWith(2, "response table beside OUT: '" + path("c_cam0_response.txt") +
                              "' is an input of this run: name another file"));
  EXPECT_FALSE(is_there("c.yaml"));
  EXPECT_EQ(read_text(path("c_cam0_response.txt")), table_text(0.75));
  std::filesystem::create_directory(path("d_cam0_response.txt"));
  EXPECT_THAT(convert("b.yaml", "d.yaml"), EndsWith(3, "d_cam0_response.txt: is a folder"));
  EXPECT_FALSE(is_there("d.yaml"));
}

TEST_F(CameraConvert, FilesThatCannotBeReadOrWrittenAre3) {
  EXPECT_THAT(convert("missing.yaml", "c.txt"), EndsWith(3, "missing.yaml"));
  EXPECT_THAT(convert("rig.yaml", "nowhere/c.txt"), EndsWith(3, "there is no folder"));
  std::filesystem::create_directory(path("closed"));
  std::filesystem::permissions(path("closed"),
                               std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  EXPECT_THAT(run_program_bound_by_permissions({"camera", "convert", path("rig.yaml"), path("closed/c.txt")}),
              EndsWith(3, "cannot be written"));
  std::filesystem::permissions(path("closed"), std::filesystem::perms::owner_all);
  EXPECT_THAT(convert("rig.yaml", "c.txt").status, 0);
}

TEST_F(CameraConvert, AFileOfNoKnownFormatIs2AndTheKnownAreNamed) {
  write_text(path("notes.yaml"), "lens: wide\n");
  const ProgramRun run = convert("notes.yaml", "c.txt");
  EXPECT_THAT(run, EndsWith(2, "notes.yaml:1: is no camera file of a known kind"));
  for (const char* title :
       {"mrcal .cameramodel", "COLMAP cameras.txt", "nerfstudio transforms.json", "ROS camera .ini"})
    EXPECT_THAT(run.err, HasSubstr(title));
}

TEST_F(CameraConvert, ToStdout) {
  const ProgramRun run = run_program(
      {"camera", "convert", path("rig.yaml"), "/dev/stdout", "--to", "wpilib", "--camera-name", "front"});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(nlohmann::json::parse(run.out)["camera_matrix"][2], 317.25);
}

TEST_F(CameraConvert, AnEstimatedResponseIsToldToBeLost) {
  write_text(path("auto.yaml"),
             R"(cam0: {camera_model: pinhole, intrinsics: [5, 6, 3, 2], distortion_model: none,
    resolution: [6, 4], response: auto})");
  EXPECT_THAT(kinds_of(run_for_json({"camera", "convert", path("auto.yaml"), path("c.txt")})["losses"]),
              ElementsAre("response"));
}

// A least-squares fit of the same lens by SciPy, with OpenCV's projection, is off by 0.224 px, 0.0474 px RMS.
TEST_F(CameraConvert, LensesWithAThinPrismAreFittedOnDemand) {
  write_text(path("oak.yaml"), R"(image_width: 640
image_height: 480
camera_matrix: {rows: 3, cols: 3, data: [606.9, 0, 317.1, 0, 608.7, 255.8, 0, 0, 1]}
distortion_model: rational_polynomial
distortion_coefficients: {rows: 1, cols: 14, data: [5.1, -30.2, 0.0004, -0.0007, 60.1, 4.9, -29.5, 58.9, 0.001, -0.002,
  0.0005, 0.0001, 0.002, -0.003]}
)");
  EXPECT_THAT(convert("oak.yaml", "c.yaml"),
              EndsWith(2, "oak.yaml:5: distortion_coefficients: has 14 coefficients"));
  EXPECT_THAT(convert("oak.yaml", "c.yaml"), EndsWith(2, "`apriltrack camera convert --fit`"));
  EXPECT_FALSE(is_there("c.yaml"));
  const ProgramRun run = convert("oak.yaml", "c.yaml", {"--fit"});
  EXPECT_THAT(run, EndsWith(0, "off by up to 0.224 px, 0.0474 px RMS over the picture"));
  EXPECT_THAT(run.err, Not(HasSubstr("not kept"))) << "told once";
  const auto told = run_for_json({"camera", "convert", path("oak.yaml"), path("c.yaml"), "--fit"});
  EXPECT_THAT(kinds_of(told["losses"]), ElementsAre("lens_terms", "unread_lens"));
  EXPECT_THAT(read_text(path("c.yaml")), HasSubstr("distortion_model: radtan"));
}

TEST_F(CameraConvert, WhatComesOutIsWhereACameraIsAnInput) {
  run_for_json({"simulate", "--scene", "single", "--frames", "2", "--output", path("film")});
  for (const auto& [name, to] : {std::pair<std::string, std::string>{"c.cameramodel", "mrcal"},
                                 {"c.txt", "colmap"},
                                 {"c.yml", "opencv"}}) {
    ASSERT_EQ(convert("film/camera.yaml", name, {"--to", to}).status, 0);
    const auto told =
        run_for_json({"detect", path("film"), "--camera", path(name), "--output", path("d.csv")});
    EXPECT_EQ(told["frames"], 2) << told.dump(1);
  }
}

TEST_F(CameraConvert, TellsWhatKalibrItselfDoesNotRead) {
  const ProgramRun run = convert("wpilib.json", "camera.yaml", {"--resolution", "640x480"});
  EXPECT_EQ(run.status, 0);
  EXPECT_THAT(run.err,
              HasSubstr("radtan with 8 coefficients, which AprilTrack reads and Kalibr itself does not"));
  EXPECT_THAT(run.err, Not(HasSubstr("not kept")));
  const auto told = run_for_json(
      {"camera", "convert", path("wpilib.json"), path("camera.yaml"), "--resolution", "640x480"});
  EXPECT_THAT(kinds_of(told["losses"]), ElementsAre("unread_lens"));
}

TEST_F(CameraConvert, NamesThatMisleadAreRefusedOrWarnedOf) {
  EXPECT_THAT(convert("wpilib.json", "c.cameramodel", {"--to", "opencv"}),
              EndsWith(2, "which is mrcal's alone"));
  EXPECT_FALSE(is_there("c.cameramodel"));
  const ProgramRun run = convert("wpilib.json", "c.json", {"--to", "opencv"});
  EXPECT_EQ(run.status, 0);
  EXPECT_THAT(run.err, HasSubstr("though its name ends in .json"));
  EXPECT_THAT(convert("wpilib.json", "c.yaml", {"--to", "opencv"}).err, Not(HasSubstr("its name ends in")));
}

using CameraShow = CameraConvert;

TEST_F(CameraShow, SaysWhatTheFileHolds) {
  const nlohmann::json told = run_for_json({"camera", "show", path("rig.yaml")});
  EXPECT_EQ(told["format"], "kalibr");
  ASSERT_EQ(told["cameras"].size(), 2U);
  const auto& front = told["cameras"][0];
  EXPECT_EQ(front["name"], "front");
  EXPECT_EQ(front["cx"], 317.25);
  EXPECT_EQ(front["distortion_coeffs"], (nlohmann::json{0.1, -0.2, 0.003, -0.004}));
  EXPECT_EQ(front["response"], "gamma:2.25");
  EXPECT_TRUE(front["T_this_previous"].is_null());
  const auto& side = told["cameras"][1];
  EXPECT_TRUE(side["response"].is_null());
  EXPECT_EQ(side["T_this_previous"]["position_m"], (nlohmann::json{{"x", 1}, {"y", 2}, {"z", 3}}));
  EXPECT_EQ(side["T_this_previous"]["position"], (nlohmann::json{{"x", 1}, {"y", 2}, {"z", 3}}));
  const ProgramRun run = run_program({"camera", "show", path("rig.yaml")});
  EXPECT_THAT(run.out, HasSubstr("Kalibr camchain YAML\nfront\n"));
  EXPECT_THAT(run.out, HasSubstr("640 x 480 px"));
}

// 2 atan(320 / 320) of a pinhole whose axis is in the middle of 640 pixels, and 2 * 90 degrees of a fisheye
// whose edges are 90 degrees from the axis.
TEST_F(CameraShow, FieldsOfViewAreFromEdgeToEdge) {
  write_text(path("square.txt"),
             "1 PINHOLE 640 640 320 320 320 320\n"
             "2 OPENCV_FISHEYE 640 320 203.71832715762602 203.71832715762602 320 160 0 0 0 0\n");
  const nlohmann::json told = run_for_json({"camera", "show", path("square.txt")});
  EXPECT_NEAR(told["cameras"][0]["field_of_view_deg"]["horizontal"].get<double>(), 90.0, 1e-3);
  EXPECT_NEAR(told["cameras"][0]["field_of_view_rad"]["horizontal"].get<double>(), 1.570796, 1e-6);
  EXPECT_NEAR(told["cameras"][1]["field_of_view_rad"]["horizontal"].get<double>(), 3.141593, 1e-6);
  EXPECT_NEAR(told["cameras"][0]["field_of_view_deg"]["diagonal"].get<double>(), 109.471, 1e-3);
  EXPECT_NEAR(told["cameras"][1]["field_of_view_deg"]["horizontal"].get<double>(), 180.0, 1e-3);
  EXPECT_NEAR(told["cameras"][1]["field_of_view_deg"]["vertical"].get<double>(), 90.0, 1e-3);
  const nlohmann::json without_size = run_for_json({"camera", "show", path("wpilib.json")});
  EXPECT_TRUE(without_size["cameras"][0]["resolution"].is_null());
  EXPECT_TRUE(without_size["cameras"][0]["field_of_view_deg"]["diagonal"].is_null());
}

TEST_F(CameraShow, EveryFileOfTheSharedCasesIsReadOrRefusedInWords) {
  APRILTRACK_SHARED_OR_SKIP(cases, "cases/camera_formats");
  for (const char* name : {"colmap_cameras.txt", "gopro_openicc.json", "isaac22_skew.yaml", "nerfstudio.json",
                           "openvins_imucam_chain.yaml", "ros1_echo.yaml", "ros2_echo.yaml", "ros33.ini",
                           "tagslam_cameras.yaml"})
    EXPECT_EQ(run_program({"camera", "show", (cases / name).string()}).status, 0) << name;
  EXPECT_THAT(run_program({"camera", "show", (cases / "rational14.yaml").string()}),
              EndsWith(2, "tilted sensor"));
}

}  // namespace
}  // namespace apriltrack::test
