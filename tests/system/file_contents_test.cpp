// What is wrong inside a file ends with status 2, and is named by file, line and key.

#include <gtest/gtest.h>

#include "one_image.h"
#include "program.h"

namespace apriltrack::test {
namespace {

using FileContents = OneImage;

struct BadFile {
  const char* name;  // of the test case
  const char* file;
  const char* find;     // text of the good file ...
  const char* replace;  // ... and what spoils it
  const char* message;  // part of what must be said
};

class BadContents : public OneImage, public ::testing::WithParamInterface<BadFile> {};

TEST_P(BadContents, Is2AndNamesFileAndCause) {
  const BadFile& bad = GetParam();
  write_text(path(bad.file), replaced(read_text(path(bad.file)), bad.find, bad.replace));
  const ProgramRun run = track();
  EXPECT_THAT(run, EndsWith(2, bad.message));
  EXPECT_THAT(run, EndsWith(2, bad.file));
}

INSTANTIATE_TEST_SUITE_P(
    Map, BadContents,
    ::testing::Values(BadFile{"DuplicateId", "map.yaml", "  - id: 0\n",
                              "  - {id: 0, size: 0.1, pose: {position: {x: 1, y: 0, z: 0}, orientation: {x: "
                              "0, y: 0, z: 0, w: 1}}}\n  - id: 0\n",
                              "tag36h11/0 is already defined at"},
                      BadFile{"NegativeSize", "map.yaml", "0.16", "-0.16", "-0.16"},
                      BadFile{"NanSize", "map.yaml", "0.16", ".nan", "size: must be"},
                      BadFile{"UnknownFamily", "map.yaml", "tag36h11", "tag37h11", "tag37h11"},
                      BadFile{"UnknownKey", "map.yaml", "    size", "    colour: red\n    size", "colour"},
                      BadFile{"MissingSize", "map.yaml", "    size: 0.16\n", "", "'size' is missing"},
                      BadFile{"NotYaml", "map.yaml", "tags:", "tags: [", "map.yaml"}),
    [](const auto& bad) { return std::string(bad.param.name); });

INSTANTIATE_TEST_SUITE_P(
    Camera, BadContents,
    ::testing::Values(BadFile{"MissingIntrinsics", "camera.yaml",
                              "  intrinsics: [500.0, 500.0, 79.5, 59.5]\n", "", "'intrinsics' is missing"},
                      BadFile{"NanIntrinsics", "camera.yaml", "79.5", ".nan", "intrinsics"},
                      BadFile{"NegativeFocalLength", "camera.yaml", "[500.0", "[-500.0", "-500"},
                      BadFile{"UnknownModel", "camera.yaml", "pinhole", "omni", "omni"},
                      BadFile{"UnknownKey", "camera.yaml", "  resolution", "  colour: red\n  resolution",
                              "colour"}),
    [](const auto& bad) { return std::string(bad.param.name); });

TEST_F(FileContents, AWrongConfigurationFileIs2AndNamesLineAndKey) {
  const auto calibrate_with = [&](const std::string& text) {
    write_text(path("options.yaml"), text);
    return calibrate({"--config", path("options.yaml")});
  };
  const ProgramRun unknown = calibrate_with("decimate: 2\ncolour: red\n");
  EXPECT_THAT(unknown, EndsWith(2, "options.yaml:2: colour: "));
  EXPECT_THAT(unknown, EndsWith(2, "map-frame"));  // the keys there are
  EXPECT_THAT(calibrate_with("decimate: 2\nmin-views: many\n"), EndsWith(2, "options.yaml:2: min-views: "));
  EXPECT_THAT(calibrate_with("min-views: [2, 3]\n"), EndsWith(2, "options.yaml:1: min-views: "));
  EXPECT_THAT(calibrate_with("quiet: perhaps\n"), EndsWith(2, "options.yaml:1: quiet: "));
  EXPECT_THAT(calibrate_with("decimate: [2\n"), EndsWith(2, "options.yaml:"));
  EXPECT_THAT(calibrate({"--config", path("nowhere.yaml")}), EndsWith(3, "nowhere.yaml"));
  // The same file with good keys is taken: what is wrong next is that there is no tag.
  EXPECT_THAT(calibrate_with("decimate: 2\nmin-views: 3\nquiet: true\n"), EndsWith(1, "no tags were seen"));
}

/// The corners of a file of ours in OpenCV's order: top-left, top-right, bottom-right, bottom-left.
std::string in_order_of_opencv(const std::string& detections) {
  std::istringstream lines(detections);
  std::string out = "timestamp_ns,camera,family,id,c0x,c0y,c1x,c1y,c2x,c2y,c3x,c3y\n", line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    for (const std::size_t cell : {0, 1, 2, 3, 10, 11, 8, 9, 6, 7, 4, 5})
      out += cells.at(cell) + (cell == 5 ? "\n" : ",");
  }
  return out;
}

TEST_F(FileContents, CornersInAnotherOrderAre2WhereverTheyAreRead) {
  run_for_json({"simulate", "--scene", "room-gentle", "--frames", "6", "--output", path("room")});
  run_for_json({"detect", path("room"), "--output", path("ours.csv")});
  ASSERT_EQ(read_text(path("ours.csv")).find("timestamp_ns,camera,family,id,c0x,c0y,c1x,c1y,c2x,c2y,c3x,c3y"),
            0U);
  write_text(path("cv.csv"), in_order_of_opencv(read_text(path("ours.csv"))));
  const std::string camera = path("room/camera.yaml");
  EXPECT_THAT(run_program({"track", "--detections", path("cv.csv"), "--camera", camera, "--map",
                           path("room/map.yaml"), "--output", path("o.tum")}),
              EndsWith(2, "cv.csv:2: the corners of this tag, and of all others, run clockwise"));
  EXPECT_THAT(run_program({"calibrate", "--detections", path("cv.csv"), "--camera", camera, "--tag-size",
                           "0.16", "--output", path("o.yaml")}),
              EndsWith(2, "cv.csv:2: the corners of this tag, and of all others, run clockwise"));
}

TEST_F(FileContents, WrongSizesFileIs2) {
  write_text(path("sizes.yaml"), "default: 0.1\nsizes:\n  7: -1\n");
  EXPECT_THAT(calibrate({"--tag-sizes", path("sizes.yaml")}), EndsWith(2, "sizes.yaml:3"));
}

TEST_F(FileContents, BadDetectionsNameLineAndColumn) {
  write_text(
      path("d.csv"),
      "timestamp_ns,camera,family,id,c0x,c0y,c1x,c1y,c2x,c2y,c3x,c3y\n1,cam0,tag36h11,0,1,2,3,nan,5,6,7,8\n");
  const std::vector<std::string> words = {"calibrate", "--detections",      path("d.csv"),
                                          "--camera",  path("camera.yaml"), "--tag-size",
                                          "0.16",      "--output",          path("new_map.yaml")};
  EXPECT_THAT(run_program(words), EndsWith(2, "d.csv:2"));
  write_text(path("d.csv"), "timestamp_ns,camera,family,id,c0x,c0y,c1x,c1y,c2x,c2y,c3x\n");
  EXPECT_THAT(run_program(words), EndsWith(2, "c3y"));
}

TEST_F(FileContents, DetectionsOfNoSuchTagOrCameraNameLineValueAndWayOut) {
  write_text(path("camera.yaml"),
             std::string(kGoodCamera) + replaced(kGoodCamera, "cam0", "cam1") +
                 "  T_cn_cnm1: [[1, 0, 0, 0.1], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n");
  const auto calibrate_row = [&](const std::string& row, const std::vector<std::string>& more = {}) {
    const std::string corners = ",10,50,40,50,40,20,10,20\n";
    write_text(path("d.csv"),
               "timestamp_ns,camera,family,id,c0x,c0y,c1x,c1y,c2x,c2y,c3x,c3y\n1,cam0,tag36h11,0" + corners +
                   "1," + row + corners);
    std::vector<std::string> words = {"calibrate", "--detections",      path("d.csv"),
                                      "--camera",  path("camera.yaml"), "--tag-size",
                                      "0.16",      "--output",          path("new_map.yaml")};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words);
  };
  const ProgramRun id = calibrate_row("cam0,tag36h11,9999"), family = calibrate_row("cam0,aruco,3"),
                   camera = calibrate_row("cam7,tag36h11,1");
  EXPECT_THAT(id,
              EndsWith(2, path("d.csv") + ":3: tag tag36h11/9999, which no map can hold: tag36h11 has ids 0 "
                                          "to 586 (is 9999); name what is printed"));
  EXPECT_THAT(family,
              EndsWith(2, path("d.csv") + ":3: tag aruco/3, which no map can hold: unknown tag family "
                                          "'aruco' (known: tag16h5, "));
  EXPECT_THAT(camera,
              EndsWith(2, path("d.csv") + ":3: camera: there is no camera 'cam7'; the camera file has "
                                          "cam0, cam1"));
  EXPECT_THAT(calibrate_row("cam0,tag36h11,1", {"--camera-name", "cam7"}),
              EndsWith(2, "--camera-name: there is no camera 'cam7'; the camera file has cam0, cam1"));
}

TEST_F(FileContents, AnInputOfNoSuchCameraIsNamed) {
  EXPECT_THAT(
      run_program({"calibrate", "cam7=" + path("frames"), "--camera", path("camera.yaml"), "--tag-size",
                   "0.16", "--output", path("new_map.yaml")}),
      EndsWith(2, "cam7=" + path("frames") + ": there is no camera 'cam7'; the camera file has cam0"));
  EXPECT_THAT(calibrate({"--camera-name", "cam7"}), EndsWith(2, "--camera-name: there is no camera 'cam7'"));
  EXPECT_THAT(track({"--camera-name", "cam7"}), EndsWith(2, "--camera-name: there is no camera 'cam7'"));
  EXPECT_THAT(detect({"--camera-name", "cam7"}),
              EndsWith(2, path("camera.yaml") + ": there is no camera 'cam7'; the camera file has cam0"));
}

/// One tag in the upper left of the camera's picture, and from the second frame on one as in a larger
/// picture.
std::string corners_of_larger_pictures() {
  std::string text = "timestamp_ns,camera,family,id,c0x,c0y,c1x,c1y,c2x,c2y,c3x,c3y\n";
  for (int frame = 1; frame <= 10; ++frame) {
    const int right = frame == 1 ? 120 : 310;
    const std::string bottom = frame == 1 ? "50" : "200", top = frame == 1 ? "20" : "170";
    for (const int id : {0, 1}) {
      const int x = right - 40 * (id + 1);
      const std::string left = std::to_string(x), other = std::to_string(x + 30);
      text += std::to_string(frame) + ",cam0,tag36h11," + std::to_string(id) + "," + left + "," + bottom +
              "," + other + "," + bottom + "," + other + "," + top + "," + left + "," + top + "\n";
    }
  }
  return text;
}

TEST_F(FileContents, CornersOfLargerPicturesNameLineSizesAndIntrinsics) {
  write_text(path("d.csv"), corners_of_larger_pictures());
  for (const ProgramRun& run :
       {run_program({"calibrate", "--detections", path("d.csv"), "--camera", path("camera.yaml"),
                     "--tag-size", "0.16", "--output", path("new_map.yaml")}),
        run_program({"track", "--detections", path("d.csv"), "--camera", path("camera.yaml"), "--map",
                     path("map.yaml"), "--output", path("out.tum"), "--method", "pnp"})}) {
    EXPECT_THAT(run,
                EndsWith(2, path("d.csv") + ":4: corner 0 of tag36h11/0 lies at (270.0, 200.0), and camera "
                                            "'cam0' is calibrated for 160 x 120 pixels; 9 of 10 frames"));
    EXPECT_THAT(run, EndsWith(2, "resolution: [320, 240]"));
  }
}

TEST_F(FileContents, AnOddCameraIsWarnedOfByEveryCommand) {
  write_text(path("camera.yaml"), replaced(kGoodCamera, "79.5", "300.0"));
  for (const ProgramRun& run : {track(), calibrate(), detect()})
    EXPECT_THAT(run, EndsWith(1, "warning: " + path("camera.yaml")));
}

}  // namespace
}  // namespace apriltrack::test
