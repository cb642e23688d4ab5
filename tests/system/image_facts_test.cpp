// Images whose size, time or bytes do not fit.

#include <gtest/gtest.h>

#include <filesystem>

#include "one_image.h"
#include "program.h"
#include "video_files.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;

using ImageFacts = OneImage;

TEST_F(ImageFacts, WrongResolutionNamesBothSizes) {
  write_image(path("frames/1000000000.pgm"), 64, 48);
  for (const ProgramRun& run : {track(), calibrate(), detect()}) {
    EXPECT_THAT(run, EndsWith(2, "64"));
    EXPECT_THAT(run, EndsWith(2, "160"));
  }
}

TEST_F(ImageFacts, OneImageOfAnotherSizeIsLeftOutAndCounted) {
  write_image(path("frames/500000000.pgm"), 64, 48);  // even the first one
  for (const ProgramRun& run : {track(), calibrate(), detect()}) {
    EXPECT_THAT(run, EndsWith(1, "1 of 2 frames are left out"));  // 1: the other one shows no tag
    EXPECT_THAT(
        run, EndsWith(1, "500000000.pgm: is 64 x 48 pixels, but camera 'cam0' is calibrated for 160 x 120"));
  }
}

TEST_F(ImageFacts, WithoutAResolutionTheFirstImageSetsIt) {
  write_text(path("camera.yaml"),
             R"({"camera_matrix": [[500, 0, 79.5], [0, 500, 59.5], [0, 0, 1]], "distortion_coefficients": )"
             R"([0, 0, 0, 0, 0]})");
  for (const ProgramRun& run : {track(), calibrate(), detect()})
    EXPECT_THAT(run, EndsWith(1, "no tag"));             // the image fits; it shows none
  write_text(path("frames/500000000.pgm"), "no image");  // the first that can be read
  write_image(path("frames/2000000000.pgm"), 64, 48);
  write_image(path("frames/3000000000.pgm"), 160, 120);
  for (const ProgramRun& run : {track(), calibrate(), detect()}) {
    EXPECT_THAT(run, EndsWith(1, "2 of 4 frames are left out"));  // 1: the others show no tag
    EXPECT_THAT(run, EndsWith(1, "no tag"));
  }
  fs::remove(path("frames/500000000.pgm"));
  EXPECT_THAT(detect(), EndsWith(1, "2000000000.pgm: is 64 x 48 pixels, but the first image, " +
                                        path("frames/1000000000.pgm") +
                                        ", is 160 x 120, and camera 'cam0' names no "
                                        "resolution: give it the right one"));
}

TEST_F(ImageFacts, WhereNoImageFitsTheFirstIsNamedBeforeAnyProgress) {
  constexpr int kMoreThanAreReadAtOnce = 70;
  fs::remove(path("frames/1000000000.pgm"));
  for (const int num_images : {3, kMoreThanAreReadAtOnce}) {
    for (int i = 0; i < num_images; ++i)
      write_image(path("frames/" + std::to_string(1000 + i) + "000000.pgm"), 64, 48);
    for (const char* threads : {"1", "8"}) {
      for (const ProgramRun& run : {track({"--threads", threads}), detect({"--threads", threads})}) {
        EXPECT_EQ(run.status, 2);
        EXPECT_EQ(run.err, "error: " + path("frames/1000000000.pgm") +
                               ": is 64 x 48 pixels, but camera 'cam0' is calibrated for 160 x 120; use the "
                               "camera file of this resolution; if the pictures were scaled by 0.4, and not "
                               "cropped, that is this one with intrinsics: [200, 200, 31.5, 23.5] and "
                               "resolution: [64, 48]\n");
      }
    }
  }
}

TEST_F(ImageFacts, ARollingShutterIsWarnedOfOnce) {
  write_text(path("camera.yaml"), std::string(kGoodCamera) + "  line_delay: 3.0e-5\n");
  for (const ProgramRun& run : {track(), calibrate()}) {
    EXPECT_THAT(run, EndsWith(1, "warning: camera 'cam0' has a rolling shutter"));
    EXPECT_EQ(run.err.find("rolling shutter"), run.err.rfind("rolling shutter"));
  }
}

TEST_F(ImageFacts, ImagesWithoutTimesNeedARate) {
  fs::rename(path("frames/1000000000.pgm"), path("frames/photo.pgm"));
  EXPECT_THAT(track(), EndsWith(2, "--rate"));
  EXPECT_THAT(track({"--rate", "10"}), EndsWith(1, "no tag of family"));
}

TEST_F(ImageFacts, FrameNumbersAreNotTakenForNanoseconds) {
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
    EXPECT_THAT(run_program(words(command)), EndsWith(2, "0002.pgm: is 1 ns after 0001.pgm"));
    EXPECT_THAT(run_program(words(command)), EndsWith(2, "--rate HZ"));
    EXPECT_THAT(run_with(words(command), {"--rate", "30"}), EndsWith(1, "no tag")) << command;
  }
}

TEST_F(ImageFacts, ACorruptImageAmongGoodOnesIsCountedAndNotTheEnd) {
  write_text(path("frames/2000000000.pgm"), "no image");
  for (const ProgramRun& run : {track(), calibrate(), detect()}) {
    EXPECT_THAT(run, EndsWith(1, "1 of 2 frames"));  // 1: the good image shows no tag
    EXPECT_THAT(run, EndsWith(1, "2000000000.pgm: is not an image"));
    EXPECT_EQ(run.err.find("2000000000.pgm"), run.err.rfind("2000000000.pgm")) << run.err;
  }
}

// Matroska rounds times to milliseconds: two of these frames have the same one, which the second cannot have.
TEST_F(ImageFacts, ADamagedFrameOfAVideoIsCountedWhateverTheVideoIsCalled) {
  VideoPlan plan;
  plan.times_ticks = {0, 3000, 3010, 6000};
  plan.pictures.assign(plan.times_ticks.size(), GrayImage(160, 120, 128));
  for (const std::string name : {"film.mkv", "20240101.mkv"}) {
    write_mjpeg_video(path(name), plan);
    const ProgramRun run =
        run_program({"detect", path(name), "--camera", path("camera.yaml"), "--output", path("d.csv")});
    const std::string frame = path(name) + " frame 2: ";
    EXPECT_THAT(run,
                EndsWith(1, "1 of 4 frames are left out; the first: " + frame + "its time, 0.033000000"));
    EXPECT_EQ(run.err.find(frame), run.err.rfind(frame)) << run.err;
  }
}

TEST_F(ImageFacts, AFolderOfWhichNothingIsReadableIs3) {
  write_text(path("frames/1000000000.pgm"), "no image");
  EXPECT_THAT(detect(), EndsWith(3, "the first: " + path("frames/1000000000.pgm") + ": is not an image"));
  EXPECT_THAT(track(), EndsWith(3, "frames"));
  EXPECT_THAT(calibrate(), EndsWith(3, "frames"));
  EXPECT_THAT(detect(), EndsWith(3, "frames"));
}

}  // namespace
}  // namespace apriltrack::test
