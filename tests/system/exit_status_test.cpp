// The exit-status table of docs/file_formats.md, row by row, through the command line.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "program.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;

const char* const kMap =
    "apriltrack_map: 1\nframe: world\ndefault_family: tag36h11\ntags:\n  - id: 0\n    size: 0.16\n    pose:\n"
    "      position: {x: 0.0, y: 0.0, z: 0.0}\n      orientation: {x: 0.0, y: 0.0, z: 0.0, w: 1.0}\n";
const char* const kCamera =
    "cam0:\n  camera_model: pinhole\n  intrinsics: [500.0, 500.0, 79.5, 59.5]\n  distortion_model: none\n"
    "  distortion_coeffs: []\n  resolution: [160, 120]\n";

/// A folder with a good camera, a good map, and one blank image; each test spoils one thing.
class ExitStatus : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = temporary_folder();
    write_text(path("camera.yaml"), kCamera);
    write_text(path("map.yaml"), kMap);
    write_image(path("frames/1000000000.pgm"), 160, 120);
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  static void write_image(const std::string& file, int width, int height) {
    write_text(file, "P5\n" + std::to_string(width) + " " + std::to_string(height) + "\n255\n" +
                         std::string(static_cast<std::size_t>(width) * height, '\x80'));
  }

  /// Good words for a command, with some options given other values, or added.
  static ProgramRun run_with(std::vector<std::string> words, const std::vector<std::string>& changes) {
    for (std::size_t i = 0; i + 1 < changes.size(); i += 2) {
      const auto option = std::find(words.begin(), words.end(), changes[i]);
      if (option == words.end()) {
        words.insert(words.end(), {changes[i], changes[i + 1]});
      } else {
        option[1] = changes[i + 1];
      }
    }
    return run_program(words);
  }

  ProgramRun track(const std::vector<std::string>& changes = {}) const {
    return run_with({"track", path("frames"), "--camera", path("camera.yaml"), "--map", path("map.yaml"),
                     "--output", path("out.tum")},
                    changes);
  }

  ProgramRun calibrate(const std::vector<std::string>& changes = {}) const {
    return run_with({"calibrate", path("frames"), "--camera", path("camera.yaml"), "--tag-size", "0.16",
                     "--output", path("new_map.yaml")},
                    changes);
  }

  ProgramRun detect(const std::vector<std::string>& changes = {}) const {
    return run_with(
        {"detect", path("frames"), "--camera", path("camera.yaml"), "--output", path("corners.csv")},
        changes);
  }

  fs::path folder_;
};

// ---- 1: it ran, and no usable result came

TEST_F(ExitStatus, NoTagSeenIs1AndSaysWhatToDo) {
  EXPECT_THAT(track(), EndsWith(1, "no tag of family tag36h11 in any of 1 frames"));
  EXPECT_THAT(track(), EndsWith(1, "is this the family that is printed"));
  EXPECT_THAT(calibrate(), EndsWith(1, "no tags were seen in 1 frames; check the tag family"));
  EXPECT_THAT(detect(), EndsWith(1, "no tag of family tag36h11 in any of 1 frames; try"));
  EXPECT_FALSE(fs::exists(path("out.tum")));
  EXPECT_FALSE(fs::exists(path("new_map.yaml")));
  EXPECT_FALSE(fs::exists(path("corners.csv")));
}

// ---- 2: the command line, a configuration or the contents of a file

TEST_F(ExitStatus, MissingOutputIs2) {
  EXPECT_THAT(
      run_program({"track", path("frames"), "--camera", path("camera.yaml"), "--map", path("map.yaml")}),
      EndsWith(2, "--output"));
  EXPECT_THAT(
      run_program({"calibrate", path("frames"), "--camera", path("camera.yaml"), "--tag-size", "0.16"}),
      EndsWith(2, "--output"));
  EXPECT_THAT(run_program({"simulate", "--scene", "room"}), EndsWith(2, "--output"));
  EXPECT_THAT(run_program({"detect", path("frames")}), EndsWith(2, "--output"));
}

struct BadFile {
  const char* name;  // of the test case
  const char* file;
  const char* find;     // text of the good file ...
  const char* replace;  // ... and what spoils it
  const char* message;  // part of what must be said
};

std::string replaced(std::string text, const std::string& find, const std::string& replace) {
  const std::size_t at = text.find(find);
  EXPECT_NE(at, std::string::npos);
  return text.replace(at, find.size(), replace);
}

class BadContents : public ExitStatus, public ::testing::WithParamInterface<BadFile> {};

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

TEST_F(ExitStatus, WrongResolutionNamesBothSizes) {
  write_image(path("frames/1000000000.pgm"), 64, 48);
  for (const ProgramRun& run : {track(), calibrate(), detect()}) {
    EXPECT_THAT(run, EndsWith(2, "64"));
    EXPECT_THAT(run, EndsWith(2, "160"));
  }
}

TEST_F(ExitStatus, OneImageOfAnotherSizeIsLeftOutAndCounted) {
  write_image(path("frames/500000000.pgm"), 64, 48);  // even the first one
  for (const ProgramRun& run : {track(), calibrate(), detect()}) {
    EXPECT_THAT(run, EndsWith(1, "1 of 2 frames are left out"));  // 1: the other one shows no tag
    EXPECT_THAT(
        run, EndsWith(1, "500000000.pgm: is 64 x 48 pixels, but camera 'cam0' is calibrated for 160 x 120"));
  }
}

TEST_F(ExitStatus, WithoutAResolutionTheFirstImageSetsIt) {
  write_text(path("camera.yaml"),
             R"({"camera_matrix": [[500, 0, 79.5], [0, 500, 59.5], [0, 0, 1]], "distortion_coefficients": )"
             R"([0, 0, 0, 0, 0]})");
  for (const ProgramRun& run : {track(), calibrate(), detect()})
    EXPECT_THAT(run, EndsWith(1, "no tag"));  // the image fits; it shows none
  write_image(path("frames/2000000000.pgm"), 64, 48);
  for (const ProgramRun& run : {track(), calibrate(), detect()}) {
    EXPECT_THAT(run, EndsWith(2, "64 x 48"));
    EXPECT_THAT(run, EndsWith(2, "160 x 120"));
  }
}

TEST_F(ExitStatus, AnOddCameraIsWarnedOfByEveryCommand) {
  write_text(path("camera.yaml"), replaced(kCamera, "79.5", "300.0"));
  for (const ProgramRun& run : {track(), calibrate(), detect()})
    EXPECT_THAT(run, EndsWith(1, "warning: " + path("camera.yaml")));
}

TEST_F(ExitStatus, ARollingShutterIsWarnedOfOnce) {
  write_text(path("camera.yaml"), std::string(kCamera) + "  line_delay: 3.0e-5\n");
  for (const ProgramRun& run : {track(), calibrate()}) {
    EXPECT_THAT(run, EndsWith(1, "warning: camera 'cam0' has a rolling shutter"));
    EXPECT_EQ(run.err.find("rolling shutter"), run.err.rfind("rolling shutter"));
  }
}

TEST_F(ExitStatus, WrongTagSizeIs2) {
  EXPECT_THAT(calibrate({"--tag-size", "-0.16"}), EndsWith(2, "-0.16"));
  EXPECT_THAT(run_program({"calibrate", path("frames"), "--camera", path("camera.yaml"), "--output",
                           path("new_map.yaml")}),
              EndsWith(2, "--tag-size"));
}

TEST_F(ExitStatus, WrongSizesFileIs2) {
  write_text(path("sizes.yaml"), "default: 0.1\nsizes:\n  7: -1\n");
  EXPECT_THAT(calibrate({"--tag-sizes", path("sizes.yaml")}), EndsWith(2, "sizes.yaml:3"));
}

TEST_F(ExitStatus, UnknownFamilyIs2AndListsTheKnown) {
  EXPECT_THAT(calibrate({"--family", "tag37h11"}), EndsWith(2, "tag36h11"));
}

TEST_F(ExitStatus, UnknownSceneIs2AndListsTheKnown) {
  EXPECT_THAT(run_program({"simulate", "--scene", "cellar", "--output", path("out")}),
              EndsWith(2, "room-gentle"));
}

TEST_F(ExitStatus, AWrongConfigurationFileIs2AndNamesLineAndKey) {
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

TEST_F(ExitStatus, ImagesWithoutTimesNeedARate) {
  fs::rename(path("frames/1000000000.pgm"), path("frames/photo.pgm"));
  EXPECT_THAT(track(), EndsWith(2, "--rate"));
  EXPECT_THAT(track({"--rate", "10"}), EndsWith(1, "no tag of family"));
}

TEST_F(ExitStatus, FrameNumbersAreNotTakenForNanoseconds) {
  write_image(path("numbered/0001.pgm"), 160, 120);
  write_image(path("numbered/0002.pgm"), 160, 120);
  const auto words = [&](const std::string& command) {
    std::vector<std::string> all = {command,    path("numbered"), "--camera", path("camera.yaml"),
                                    "--output", path("out")};
    if (command == "track") all.insert(all.end(), {"--map", path("map.yaml")});
    if (command == "calibrate") all.insert(all.end(), {"--tag-size", "0.16"});
    return all;
  };
  for (const std::string command : {"detect", "calibrate", "track"}) {
    EXPECT_THAT(run_program(words(command)), EndsWith(2, "0002.pgm: is 1 ns after the frame before"));
    EXPECT_THAT(run_program(words(command)), EndsWith(2, "--rate HZ"));
    EXPECT_THAT(run_with(words(command), {"--rate", "30"}), EndsWith(1, "no tag")) << command;
  }
}

TEST_F(ExitStatus, ANumberOutOfRangeIs2WithTheOptionsOwnName) {
  const auto detect_with = [&](const char* option, const char* value) { return detect({option, value}); };
  EXPECT_THAT(calibrate({"--step", "-1"}),
              EndsWith(2, "--step: must be a whole number of at least 1 (is '-1')"));
  EXPECT_THAT(calibrate({"--step", "0"}),
              EndsWith(2, "--step: must be a whole number of at least 1 (is '0')"));
  EXPECT_THAT(calibrate({"--max-frames", "-2"}),
              EndsWith(2, "--max-frames: must be a whole number of at least 1"));
  EXPECT_THAT(calibrate({"--min-views", "0"}), EndsWith(2, "--min-views: must be a whole number from 1"));
  EXPECT_THAT(calibrate({"--decimate", "0.3"}), EndsWith(2, "--decimate: must be 1, 1.5"));
  EXPECT_THAT(calibrate({"--map-frame", ""}), EndsWith(2, "--map-frame: must not be empty"));
  EXPECT_THAT(calibrate({"--rate", "-1"}), EndsWith(2, "--rate: must be in [0.001, 1000000]"));
  EXPECT_THAT(detect_with("--rate", "nan"), EndsWith(2, "--rate: must be in [0.001, 1000000]"));
  EXPECT_THAT(detect_with("--threads", "-1"),
              EndsWith(2, "--threads: must be a whole number from 0 to 256 (is '-1')"));
  EXPECT_THAT(detect_with("--max-hamming", "3"),
              EndsWith(2, "--max-hamming: must be a whole number from 0 to 2"));
  EXPECT_THAT(track({"--min-margin", "-1"}), EndsWith(2, "--min-margin: must be in [0, 255]"));
  EXPECT_THAT(run_program({"simulate", "--scene", "single", "--seed", "-1", "--output", path("s")}),
              EndsWith(2, "--seed: must be a whole number of at least 0 (is '-1')"));
  EXPECT_THAT(run_program({"demo", "--seed", "-1", "--output", path("s")}), EndsWith(2, "--seed: must be"));
  EXPECT_THAT(run_program({"map", "merge", path("map.yaml"), path("map.yaml"), "--conflict-mm", "-1",
                           "--output", path("merged.yaml")}),
              EndsWith(2, "--conflict-mm: must be at least 0 (is '-1')"));
  write_text(path("options.yaml"), "step: -1\n");
  EXPECT_THAT(calibrate({"--config", path("options.yaml")}),
              EndsWith(2, "options.yaml:1: step: --step: must be"));
}

TEST_F(ExitStatus, TheLargestSeedIsTaken) {
  EXPECT_EQ(run_program({"simulate", "--scene", "single", "--frames", "1", "--seed", "18446744073709551615",
                         "--output", path("s")})
                .status,
            0);
}

TEST_F(ExitStatus, AFamilyGivenTwiceIs2) {
  EXPECT_THAT(run_with({"detect", path("frames"), "--output", path("d.csv"), "--family", "tag25h9",
                        "--family", "tag25h9"},
                       {}),
              EndsWith(2, "--family: 'tag25h9' is given more than once"));
}

TEST_F(ExitStatus, ACameraIsNamedOnce) {
  EXPECT_THAT(run_program({"calibrate", "cam0=" + path("frames"), "--camera", path("camera.yaml"),
                           "--camera-name", "cam0", "--tag-size", "0.16", "--output", path("new_map.yaml")}),
              EndsWith(2, "--camera-name"));
}

TEST_F(ExitStatus, BadDetectionsNameLineAndColumn) {
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

TEST_F(ExitStatus, AnInputIsNeverOverwritten) {
  for (const std::string name : {"camera.yaml", "map.yaml"}) {
    const std::string before = read_text(path(name));
    EXPECT_THAT(track({"--output", path(name)}), EndsWith(2, "is an input"));
    EXPECT_EQ(read_text(path(name)), before);
  }
  EXPECT_THAT(calibrate({"--output", path("camera.yaml")}), EndsWith(2, "is an input"));
  EXPECT_THAT(track({"--frames-csv", path("out.tum")}), EndsWith(2, "--frames-csv"));
}

TEST_F(ExitStatus, AnEmptyOutputIs2AndThreadsHaveALimit) {
  EXPECT_THAT(track({"--output", ""}), EndsWith(2, "--output"));
  EXPECT_THAT(calibrate({"--threads", "20000"}), EndsWith(2, "20000"));
  EXPECT_THAT(run_program({"detect", path("frames"), "--output", path("d.csv"), "--threads", "20000"}),
              EndsWith(2, "20000"));
}

// ---- 3: an input or output cannot be opened, read or written

TEST_F(ExitStatus, MissingInputsAre3) {
  fs::remove_all(path("frames"));
  EXPECT_THAT(track(), EndsWith(3, "frames"));
  fs::create_directories(path("frames"));
  EXPECT_THAT(track(), EndsWith(3, "frames"));  // an empty folder
}

TEST_F(ExitStatus, MissingMapOrCameraIs3) {
  EXPECT_THAT(track({"--map", path("nowhere.yaml")}), EndsWith(3, "nowhere.yaml"));
  EXPECT_THAT(track({"--camera", path("nowhere.yaml")}), EndsWith(3, "nowhere.yaml"));
  EXPECT_THAT(run_program({"evaluate", "--truth", path("nowhere.tum"), "--estimate", path("x.tum")}),
              EndsWith(3, "nowhere.tum"));
  EXPECT_THAT(run_program({"map", "show", path("nowhere.yaml")}), EndsWith(3, "nowhere.yaml"));
}

TEST_F(ExitStatus, AFolderOfWhichNothingIsReadableIs3) {
  write_text(path("frames/1000000000.pgm"), "no image");
  EXPECT_THAT(track(), EndsWith(3, "frames"));
  EXPECT_THAT(calibrate(), EndsWith(3, "frames"));
  EXPECT_THAT(detect(), EndsWith(3, "frames"));
}

TEST_F(ExitStatus, ACorruptImageAmongGoodOnesIsCountedAndNotTheEnd) {
  write_text(path("frames/2000000000.pgm"), "no image");
  for (const ProgramRun& run : {track(), calibrate(), detect()}) {
    EXPECT_THAT(run, EndsWith(1, "1 of 2 frames"));  // 1: the good image shows no tag
    EXPECT_THAT(run, EndsWith(1, "2000000000.pgm"));
  }
}

TEST_F(ExitStatus, AnUnwritableOutputIs3BeforeTheWorkIsDone) {
  EXPECT_THAT(run_program({"simulate", "--scene", "single", "--frames", "1", "--output", "/proc/nowhere"}),
              EndsWith(3, "/proc/nowhere"));
  EXPECT_THAT(track({"--output", path("missing/out.tum")}), EndsWith(3, "missing/out.tum"));
  EXPECT_THAT(calibrate({"--output", path("missing/map.yaml")}), EndsWith(3, "missing/map.yaml"));
  EXPECT_THAT(detect({"--output", path("missing/corners.csv")}), EndsWith(3, "missing/corners.csv"));
}

TEST_F(ExitStatus, AFullFolderIs3AndTheWayOutIsForce) {
  EXPECT_THAT(run_program({"simulate", "--scene", "single", "--frames", "1", "--output", path("frames")}),
              EndsWith(3, "frames: is not empty: name a new folder, or give --force"));
}

TEST_F(ExitStatus, AFolderAsOutputIs3) {
  EXPECT_THAT(track({"--output", path("frames")}), EndsWith(3, "is a folder"));
  EXPECT_THAT(calibrate({"--output", path("frames")}), EndsWith(3, "is a folder"));
}

TEST_F(ExitStatus, AFailedRunKeepsTheOldOutput) {
  write_text(path("out.tum"), "old\n");
  write_text(path("new_map.yaml"), "old\n");
  EXPECT_EQ(track().status, 1);
  EXPECT_EQ(calibrate().status, 1);
  EXPECT_EQ(read_text(path("out.tum")), "old\n");
  EXPECT_EQ(read_text(path("new_map.yaml")), "old\n");
}

}  // namespace
}  // namespace apriltrack::test
