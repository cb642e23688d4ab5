// `doctor` on recordings each of which has one fault, put there on purpose.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "apriltrack/source/image_file.h"
#include "one_image.h"
#include "painted_recording.h"
#include "program.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;
using ::testing::HasSubstr;

TEST_F(Doctor, FindsNothingWrongWithAGoodRecording) {
  film(8, paint(kThreeTags));
  const ProgramRun run = look();
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err.find("warning"), std::string::npos) << run.err;
  EXPECT_THAT(run.out, HasSubstr("8 frames of 480 x 160, 10 a second"));
  EXPECT_THAT(run.out, HasSubstr("all 3 tags are joined"));
  EXPECT_THAT(run.out, HasSubstr("verdict: ready to calibrate"));
}

TEST_F(Doctor, TellsProgramsTheSame) {
  film(8, paint(kThreeTags));
  const ProgramRun run = look({"--json", "--quiet"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err, "");
  const auto told = nlohmann::json::parse(run.out);
  EXPECT_EQ(told["verdict"], "ready");
  EXPECT_TRUE(told["findings"].empty() && told["warnings"].empty());
  EXPECT_EQ(told["recordings"][0]["frames_with_tags"], 8);
  EXPECT_NEAR(told["recordings"][0]["rate_hz"].get<double>(), 10.0, 1e-9);
  EXPECT_EQ(told["recordings"][0]["blur"]["frames_sharp"], 8);
  ASSERT_EQ(told["tags"].size(), 3u);
  EXPECT_EQ(told["tags"][0]["tag"], "tag36h11/1");
  EXPECT_NEAR(told["tags"][0]["edge_px"][1].get<double>(), 64.0, 0.5);
  EXPECT_EQ(told["groups"].size(), 1u);
}

// Which calibrate refuses.
TEST_F(Doctor, StopsWhereTheCameraStoodStill) {
  film(1, paint(kThreeTags));
  for (int i = 1; i < 8; ++i)
    fs::copy_file(folder_ / "frames" / "1000000000.png",
                  folder_ / "frames" / (std::to_string(1'000'000'000 + 100'000'000LL * i) + ".png"));
  const ProgramRun run = look();
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(run.out,
              HasSubstr("all 8 pictures of two tags or more are from one place (the camera stood still, "));
}

TEST_F(Doctor, TellsOfMixedResolutions) {
  film(8, paint(kThreeTags));
  film(2, paint(kThreeTags, 500));
  EXPECT_THAT(look(), EndsWith(0, "images of 2 sizes (8 of 480 x 160, 2 of 500 x 160)"));
}

TEST_F(Doctor, TellsOfACameraFileOfAnotherResolution) {
  film(8, paint(kThreeTags, 500));
  const ProgramRun run = look();
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(run.out, HasSubstr("the images are 500 x 160 pixels, but camera 'cam0' is calibrated for 480"));
  EXPECT_THAT(look({"--json"}), EndsWith(1, "the images are 500 x 160 pixels"));
}

TEST_F(Doctor, NamesTheFamilyThatIsThere) {
  film(8, paint({{"tag25h9", 1, 0}, {"tag25h9", 2, 1}}));
  const ProgramRun run = run_program({"doctor", folder_.string()});
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(run.out, HasSubstr("no tag36h11, but 16 readings of tag25h9 in 8 frames looked at: use "
                                 "--family tag25h9"));
  EXPECT_EQ(look({"--family", "tag25h9"}).status, 0);
}

TEST_F(Doctor, KnowsTagsOfKalibrsGrids) {
  film(8, paint({{"tag36h11b2", 1, 0}, {"tag36h11b2", 2, 1}, {"tag36h11b2", 3, 2}}));
  const ProgramRun run = run_program({"doctor", folder_.string()});
  EXPECT_THAT(run.out + run.err, HasSubstr("24 readings of tag36h11b2 in 8 frames looked at (the two-cell "
                                           "border of Kalibr's printed grids)"));
  EXPECT_THAT(run.out + run.err, HasSubstr("--family tag36h11b2"));
}

TEST_F(Doctor, NamesTheFamilyThatHangsBeside) {
  film(8, paint({{"tag36h11", 1, 0}, {"tag36h11", 2, 1}, {"tag25h9", 1, 2}}));
  const ProgramRun run = run_program({"doctor", folder_.string()});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("besides tag36h11 there are 2 readings of tag25h9 in 2 frames looked at"));
}

TEST_F(Doctor, TakesNoFamilyForAnother) {
  film(8, paint(kThreeTags));
  const ProgramRun run = run_program({"doctor", folder_.string(), "--json"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(nlohmann::json::parse(run.out)["findings"], nlohmann::json::array());
}

TEST_F(Doctor, SaysThatTagsAreLightOnDark) {
  GrayImage picture = paint(kThreeTags);
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x) picture(x, y) = static_cast<std::uint8_t>(255 - picture(x, y));
  film(4, picture);
  EXPECT_THAT(look().out,
              HasSubstr("the tags are light on dark: they are read in the negative of the pictures"));
  const ProgramRun machine = look({"--json"});
  EXPECT_EQ(nlohmann::json::parse(machine.out)["findings"][0]["about"], "inverted");
}

TEST_F(Doctor, TellsOfGroupsThatNoFrameJoins) {
  film(8, paint({{"tag36h11", 1, 0}, {"tag36h11", 2, 1}}));
  film(8, paint({{"tag36h11", 3, 0}, {"tag36h11", 4, 1}}));
  EXPECT_THAT(look(), EndsWith(0, "2 groups that no frame joins: {tag36h11/1, tag36h11/2} | {tag36h11/3"));
}

TEST_F(Doctor, CamerasOfARigJoinTheTagsOfAMoment) {
  for (const std::string camera : {"left", "right"}) {
    fs::create_directories(folder_ / camera);
    for (int i = 1; i <= 6; ++i)
      write_image(folder_ / camera / (std::to_string(i) + "00000000.png"),
                  seen_in_passing(paint({{"tag36h11", camera == "left" ? 1 : 2, 0}}), i).view());
  }
  const auto doctor = [&](const std::string& second) {
    return run_program({"doctor", "cam0=" + path("left"), second, "--no-other-families"});
  };
  const ProgramRun rig = doctor("cam1=" + path("right"));
  EXPECT_EQ(rig.status, 0) << rig.err;
  EXPECT_THAT(rig.out, HasSubstr("all 2 tags are joined"));
  const ProgramRun takes = doctor("cam0=" + path("right"));  // one camera, one film after the other
  EXPECT_EQ(takes.status, 1);
  EXPECT_THAT(takes.out, HasSubstr("no two tags are ever in view together (2 seen)"));
}

TEST_F(Doctor, TellsOfAnIdThatIsThereTwice) {
  film(8, paint({{"tag36h11", 1, 0}, {"tag36h11", 2, 1}, {"tag36h11", 2, 2}}));
  EXPECT_THAT(look(), EndsWith(0, "the same id is seen twice at once: tag36h11/2 (8 of 8 frames)"));
}

TEST_F(Doctor, SaysOfALoneTagThatItCanBeTracked) {
  film(8, paint({{"tag36h11", 1, 0}}));
  const ProgramRun run = look();
  EXPECT_THAT(run, EndsWith(1, "error: doctor: the verdict above says why"));
  EXPECT_THAT(run.out, HasSubstr("verdict: will not calibrate: only one tag was seen, tag36h11/1"));
  EXPECT_THAT(run.out, HasSubstr("it can be tracked"));
}

TEST_F(Doctor, TellsOfBlankFramesAndOfUnreadableOnes) {
  film(8, paint(kThreeTags));
  film(1, GrayImage(480, 160, 0));
  write_text(folder_ / "frames" / "5000000000.png", "no image");
  EXPECT_THAT(look(), EndsWith(0, "1 of 10 frames are left out; the first: "));
  EXPECT_THAT(look(), EndsWith(0, "1 of 9 frames are of one brightness"));
}

TEST_F(Doctor, NeedsNeitherTimesNorACamera) {
  fs::create_directories(folder_ / "photos");
  for (int i = 0; i < 5; ++i)
    write_image(folder_ / "photos" / (std::string(1, static_cast<char>('a' + i)) + ".png"),
                seen_in_passing(paint(kThreeTags), i).view());
  const ProgramRun run = run_program({"doctor", path("photos"), "--no-other-families"});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("note: the images' names are no times"));
  EXPECT_THAT(run.out, HasSubstr("note: no camera file was given"));
}

TEST_F(Doctor, NoTagsAtAllIs1WithTheWayOut) {
  GrayImage wall = paint({});
  for (int x = 0; x < 240; ++x) wall(x, 80) = 30;
  for (int y = 0; y < 80; ++y) std::fill_n(wall.row(y), 480, std::uint8_t{60});
  film(3, wall);
  EXPECT_THAT(look({"--json"}), EndsWith(1, "no tag of tag36h11 in 3 frames"));
}

TEST_F(Doctor, WrongInputsAre2And3) {
  film(3, paint(kThreeTags));
  EXPECT_THAT(look({"--family", "tag99"}), EndsWith(2, "--family"));
  EXPECT_THAT(look({"--camera", path("none.yaml")}), EndsWith(3, "none.yaml"));
  write_text(path("camera.yaml"), "cam0: {}\n");
  EXPECT_THAT(look(), EndsWith(2, "camera.yaml"));
  EXPECT_THAT(run_program({"doctor", path("nothing")}), EndsWith(3, "no such file or folder"));
  EXPECT_THAT(run_program({"doctor"}), EndsWith(2, "INPUT"));
}

TEST_F(Doctor, TheNumberOfThreadsChangesNothing) {
  film(9, paint(kThreeTags));
  EXPECT_EQ(look({"--json", "--threads", "1"}).out, look({"--json", "--threads", "3"}).out);
}

}  // namespace
}  // namespace apriltrack::test
