// What is wrong on the command line ends with status 2, and is named by its option.

#include <gtest/gtest.h>

#include <array>

#include "one_image.h"
#include "program.h"

namespace apriltrack::test {
namespace {

using OptionValues = OneImage;

TEST_F(OptionValues, MissingOutputIs2) {
  EXPECT_THAT(
      run_program({"track", path("frames"), "--camera", path("camera.yaml"), "--map", path("map.yaml")}),
      EndsWith(2, "--output"));
  EXPECT_THAT(
      run_program({"calibrate", path("frames"), "--camera", path("camera.yaml"), "--tag-size", "0.16"}),
      EndsWith(2, "--output"));
  EXPECT_THAT(run_program({"simulate", "--scene", "room"}), EndsWith(2, "--output"));
  EXPECT_THAT(run_program({"detect", path("frames")}), EndsWith(2, "--output"));
}

TEST_F(OptionValues, AnOptionOfOneValueGivenTwiceIs2AndNamesBoth) {
  EXPECT_THAT(run_program({"track", path("frames"), "--output", path("o.tum"), "--video", "a.mp4", "--video",
                           "b.mp4"}),
              EndsWith(2, "error: --video: is given 2 times ('a.mp4', 'b.mp4'): give it once"));
  EXPECT_THAT(
      run_program({"simulate", "--scene", "single", "--output", "a", "--output", "b", "--output", "c"}),
      EndsWith(2, "error: --output: is given 3 times ('a', 'b', 'c'): give it once"));
  EXPECT_THAT(run_program({"map", "align", "--output", "a", "--output", "b"}),
              EndsWith(2, "error: --output: is given 2 times ('a', 'b'): give it once"));
}

TEST_F(OptionValues, WrongTagSizeIs2) {
  EXPECT_THAT(calibrate({"--tag-size", "-0.16"}), EndsWith(2, "-0.16"));
  EXPECT_THAT(run_program({"calibrate", path("frames"), "--camera", path("camera.yaml"), "--output",
                           path("new_map.yaml")}),
              EndsWith(2, "--tag-size"));
}

TEST_F(OptionValues, UnknownFamilyIs2AndListsTheKnown) {
  EXPECT_THAT(calibrate({"--family", "tag37h11"}), EndsWith(2, "tag36h11"));
}

TEST_F(OptionValues, UnknownSceneIs2AndListsTheKnown) {
  EXPECT_THAT(run_program({"simulate", "--scene", "cellar", "--output", path("out")}),
              EndsWith(2, "room-gentle"));
}

TEST_F(OptionValues, ANumberOutOfRangeIs2WithTheOptionsOwnName) {
  const auto detect_with = [&](const char* option, const char* value) { return detect({option, value}); };
  EXPECT_THAT(calibrate({"--step", "-1"}),
              EndsWith(2, "--step: must be a whole number of at least 1 (is '-1')"));
  EXPECT_THAT(calibrate({"--step", "0"}),
              EndsWith(2, "--step: must be a whole number of at least 1 (is '0')"));
  EXPECT_THAT(track({"--particles", "0"}),
              EndsWith(2, "--particles: must be a whole number from 1 to 10000000 (is '0')"));
  EXPECT_THAT(run_program({"demo", "--output", path("demo"), "--frames", "7"}),
              EndsWith(2, "--frames: must be a whole number from 8 to 10000 (is '7')"));
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
  EXPECT_THAT(run_program({"map", "merge", path("map.yaml"), path("map.yaml"), "--conflict-mm", "-1",
                           "--output", path("merged.yaml")}),
              EndsWith(2, "--conflict-mm: must be at least 0 (is '-1')"));
  write_text(path("options.yaml"), "step: -1\n");
  EXPECT_THAT(calibrate({"--config", path("options.yaml")}),
              EndsWith(2, "options.yaml:1: step: --step: must be"));
}

TEST_F(OptionValues, AHeldTagBeyondAllIdsIsNotTakenForAnother) {
  for (const std::string id : {"4294967297", "2147483648", "tag36h11/4294967297", "-1"}) {
    EXPECT_THAT(
        calibrate({"--held-tag", id}),
        EndsWith(2, "--held-tag: must be ID or family/ID, ID from 0 to 2147483647 (is '" + id + "')"));
  }
  EXPECT_THAT(calibrate({"--held-tag", "2147483647"}), EndsWith(1, "no tags were seen"));
  EXPECT_THAT(calibrate({}), EndsWith(1, "apriltrack doctor looks for tags of other families"));
}

TEST_F(OptionValues, AHeldTagThatIsNoneIsToldBeforeAnythingIsSeen) {
  EXPECT_THAT(
      calibrate({"--held-tag", "aruco/3"}),
      EndsWith(2, "--held-tag: 'aruco/3' is no tag: unknown tag family 'aruco' (known: tag16h5, tag25h9, "));
  EXPECT_THAT(calibrate({"--held-tag", "/3"}),
              EndsWith(2, "--held-tag: '/3' is no tag: unknown tag family ''"));
  EXPECT_THAT(calibrate({"--origin", "tag36h11/587"}),
              EndsWith(2, "--held-tag: 'tag36h11/587' is no tag: tag36h11 has ids 0 to 586 (is 587)"));
  EXPECT_THAT(calibrate({"--held-tag", "tag36h11/586"}), EndsWith(1, "no tags were seen"));
}

TEST_F(OptionValues, TheLargestSeedIsTaken) {
  EXPECT_EQ(run_program({"simulate", "--scene", "single", "--frames", "1", "--seed", "18446744073709551615",
                         "--output", path("s")})
                .status,
            0);
}

TEST_F(OptionValues, ASeedThatIsNoneIsNotTakenForAnother) {
  for (const std::string seed :
       {"-1", "abc", "1.5", "1e3", "0x", "18446744073709551616", "99999999999999999999999"}) {
    const auto refused =
        EndsWith(2, "--seed: must be a whole number from 0 to 18446744073709551615 (is '" + seed + "')");
    EXPECT_THAT(run_program({"simulate", "--scene", "single", "--frames", "1", "--seed", seed, "--output",
                             path("s")}),
                refused);
    EXPECT_THAT(run_program({"demo", "--seed", seed, "--output", path("s")}), refused);
    EXPECT_THAT(track({"--seed", seed}), refused);
  }
}

TEST_F(OptionValues, AnOptionThatTheMethodDoesNotUseIs2) {
  const std::vector<std::array<std::string, 4>> cases = {{"--paper-variant", "program", "blur", "paper"},
                                                         {"--paper-variant", "printed", "pnp", "paper"},
                                                         {"--particles", "500", "pnp", "blur and paper"},
                                                         {"--seed", "1", "pnp", "blur and paper"}};
  for (const auto& [option, value, method, users] : cases) {
    EXPECT_THAT(track({"--method", method, option, value}),
                EndsWith(2, option + ": is of --method " + users +
                                " and would change nothing with --method " + method));
  }
  EXPECT_THAT(track({"--paper-variant", "program"}), EndsWith(2, "nothing with --method blur"));
  write_text(path("d.csv"), "timestamp_ns,camera,family,id,c0x,c0y,c1x,c1y,c2x,c2y,c3x,c3y\n");
  EXPECT_THAT(
      run_program({"track", "--detections", path("d.csv"), "--camera", path("camera.yaml"), "--map",
                   path("map.yaml"), "--output", path("out.tum"), "--seed", "1"}),
      EndsWith(2, "--seed: is of --method blur and paper and would change nothing with --method pnp"));
}

TEST_F(OptionValues, AnOptionThatTheMethodUsesIsTaken) {
  const std::string nothing_to_see = "no tag of family";  // the run came to its end
  EXPECT_THAT(track({"--method", "paper", "--paper-variant", "program", "--particles", "20", "--seed", "2"}),
              EndsWith(1, nothing_to_see));
  EXPECT_THAT(track({"--method", "blur", "--particles", "20", "--seed", "2"}), EndsWith(1, nothing_to_see));
  EXPECT_THAT(track({"--method", "pnp"}), EndsWith(1, nothing_to_see));
}

TEST_F(OptionValues, ACameraWithoutItsRecordingIsNamed) {
  EXPECT_THAT(run_program({"calibrate", "cam0=", path("frames"), "--camera", path("camera.yaml"),
                           "--tag-size", "0.16", "--output", path("new_map.yaml")}),
              EndsWith(2, "'cam0=' names a camera, but no recording"));
}

TEST_F(OptionValues, AConfigFileKnowsAnOptionByBothItsNames) {
  for (const std::string name : {"held-tag", "origin"}) {
    write_text(path("options.yaml"), name + ": -1\n");
    EXPECT_THAT(calibrate({"--config", path("options.yaml")}),
                EndsWith(2, "--held-tag: must be ID or family/ID, ID from 0 to 2147483647 (is '-1')"))
        << name;
  }
}

TEST_F(OptionValues, JsonIsJsonWhateverBytesAPathHas) {
  const ProgramRun run = run_program(
      {"simulate", "--scene", "single", "--frames", "1", "--json", "--quiet", "--output", path("caf\xE9")});
  ASSERT_EQ(run.status, 0) << run.err;
  const nlohmann::json summary = nlohmann::json::parse(run.out, nullptr, false);
  ASSERT_TRUE(summary.is_object()) << run.out;
  EXPECT_EQ(summary["frames"], 1);
  EXPECT_TRUE(summary["output"].get<std::string>().ends_with("caf\xEF\xBF\xBD"));
}

TEST_F(OptionValues, AFamilyGivenTwiceIs2) {
  EXPECT_THAT(run_with({"detect", path("frames"), "--output", path("d.csv"), "--family", "tag25h9",
                        "--family", "tag25h9"},
                       {}),
              EndsWith(2, "--family: 'tag25h9' is given more than once"));
}

TEST_F(OptionValues, ACameraIsNamedOnce) {
  EXPECT_THAT(run_program({"calibrate", "cam0=" + path("frames"), "--camera", path("camera.yaml"),
                           "--camera-name", "cam0", "--tag-size", "0.16", "--output", path("new_map.yaml")}),
              EndsWith(2, "--camera-name"));
}

TEST_F(OptionValues, AnEmptyTextIs2WithTheOptionsOwnName) {
  EXPECT_THAT(track({"--output", ""}), EndsWith(2, "--output: must not be empty"));
  EXPECT_THAT(run_program({"map", "diff", "", path("map.yaml")}), EndsWith(2, "TRUE: must not be empty"));
  EXPECT_THAT(run_program({"evaluate", "--truth", "", "--estimate", path("e.tum")}),
              EndsWith(2, "--truth: must not be empty"));
  EXPECT_THAT(run_program({"simulate", "--scene", "single", "--output", ""}),
              EndsWith(2, "--output: must not be empty"));
}

TEST_F(OptionValues, AnOptionIsNoValueOfAnother) {
  EXPECT_THAT(track({"--output", "--json"}), EndsWith(2, "--output: has no value: --json follows"));
  EXPECT_THAT(run_program({"map", "convert", path("map.yaml"), path("o"), "--to", "--bundle", "x"}),
              EndsWith(2, "--to: has no value: --bundle follows"));
  EXPECT_FALSE(std::filesystem::exists("--json"));
}

TEST_F(OptionValues, MapsThatDoNotFitAreBothNamed) {
  std::string other = read_text(path("map.yaml"));
  other.replace(other.find("tag36h11"), 8, "tag25h9");
  write_text(path("other.yaml"), other);
  const std::string both = path("map.yaml") + " and " + path("other.yaml");
  const std::vector<std::string> maps = {path("map.yaml"), path("other.yaml")};
  EXPECT_THAT(run_with({"map", "diff"}, maps), EndsWith(1, both));
  EXPECT_THAT(run_with({"map", "align", "--output", path("x.yaml")}, maps), EndsWith(1, both));
  EXPECT_THAT(run_with({"map", "merge", "--output", path("x.yaml")}, maps), EndsWith(1, both));
}

TEST_F(OptionValues, ThreadsHaveALimit) {
  EXPECT_THAT(calibrate({"--threads", "20000"}), EndsWith(2, "20000"));
  EXPECT_THAT(run_program({"detect", path("frames"), "--output", path("d.csv"), "--threads", "20000"}),
              EndsWith(2, "20000"));
}

}  // namespace
}  // namespace apriltrack::test
