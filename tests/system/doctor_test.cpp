// `doctor` on recordings each of which has one fault, put there on purpose.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "apriltrack/source/image_file.h"
#include "apriltrack/tags/tag_family.h"
#include "one_image.h"
#include "program.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr int kCell_px = 8;  // a tag of 36h11 is 64 px wide

struct PaintedTag {
  std::string family;
  int id = 0;
  int column = 0;  ///< Of places side by side; three fit into a picture.
};

/// A grey picture of 480 x 160 pixels with tags on white paper; a pixel shows the mean of 2 x 2 pixels' area.
GrayImage paint(const std::vector<PaintedTag>& tags, int width = 480) {
  constexpr int kSamples = 4;  // a pixel and axis
  GrayImage image(width, 160, 110);
  for (const PaintedTag& tag : tags) {
    const TagPattern pattern = TagFamily::get(tag.family).pattern(tag.id);
    const double middle_x = 80.3 + 150.0 * tag.column, middle_y = 79.6;
    const double half_px = 0.5 * kCell_px * pattern.width_at_border();
    const int reach_px = static_cast<int>(half_px) + 2 * kCell_px;
    for (int y = 80 - reach_px; y <= 80 + reach_px; ++y) {
      for (int x = static_cast<int>(middle_x) - reach_px; x <= static_cast<int>(middle_x) + reach_px; ++x) {
        double sum = 0.0;
        for (int i = 0; i < kSamples * kSamples; ++i) {
          const double dx = 2.0 * (i % kSamples + 0.5) / kSamples - 1.0;
          const double dy = 2.0 * (i / kSamples + 0.5) / kSamples - 1.0;
          sum += pattern.brightness((x + dx - middle_x) / half_px, (y + dy - middle_y) / half_px);
        }
        image(x, y) = static_cast<std::uint8_t>(20.0 + 200.0 * sum / (kSamples * kSamples));
      }
    }
  }
  return image;
}

/// As a camera sees it that goes past, two pixels from frame to frame.
GrayImage seen_in_passing(const GrayImage& picture, int frame) {
  const int shift_px = 2 * frame;
  GrayImage image(picture.width(), picture.height());
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x) image(x, y) = picture(std::max(0, x - shift_px), y);
  return image;
}

constexpr const char* kCamera =
    "cam0:\n  camera_model: pinhole\n  intrinsics: [500.0, 500.0, 239.5, 79.5]\n  distortion_model: none\n"
    "  distortion_coeffs: []\n  resolution: [480, 160]\n  exposure_time: 0.01\n  response: linear\n";

class Doctor : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = temporary_folder();
    write_text(path("camera.yaml"), kCamera);
    fs::create_directories(folder_ / "frames");
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  /// `count` more frames, at 10 Hz, by a camera that goes past.
  void film(int count, const GrayImage& picture) {
    for (int i = 0; i < count; ++i, ++num_frames_)
      write_image(folder_ / "frames" / (std::to_string(1'000'000'000 + 100'000'000LL * num_frames_) + ".png"),
                  seen_in_passing(picture, num_frames_).view());
  }

  ProgramRun look(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {"doctor", folder_.string(), "--no-other-families"};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words);
  }

  fs::path folder_;
  int num_frames_ = 0;
};

const std::vector<PaintedTag> kThreeTags = {{"tag36h11", 1, 0}, {"tag36h11", 2, 1}, {"tag36h11", 3, 2}};

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

/// As selfie cameras do.
GrayImage mirrored(GrayImage image) {
  for (int y = 0; y < image.height(); ++y) std::reverse(image.row(y), image.row(y) + image.width());
  return image;
}

/// A map that has one of the painted tags.
constexpr const char* kMap =
    "apriltrack_map: 1\nframe: world\ndefault_family: tag36h11\ntags:\n  - id: 1\n    size: 0.16\n    pose:\n"
    "      position: {x: 0.0, y: 0.0, z: 0.0}\n      orientation: {x: 0.0, y: 0.0, z: 0.0, w: 1.0}\n";

TEST_F(Doctor, AndAllThatDetectSayThatPicturesAreMirrored) {
  film(4, mirrored(paint(kThreeTags)));
  write_text(path("map.yaml"), kMap);
  const auto input = folder_.string();
  const std::string says = "the pictures are mirrored: tags are read in their mirror image (tag36h11/1";
  const ProgramRun doctor = look();
  EXPECT_EQ(doctor.status, 1);
  EXPECT_THAT(doctor.out, HasSubstr("will not calibrate: " + says));
  EXPECT_EQ(doctor.out.find("no tag of"), std::string::npos) << doctor.out;
  EXPECT_THAT(run_program({"detect", input, "--output", path("d.csv")}), EndsWith(1, says));
  EXPECT_THAT(run_program({"calibrate", input, "--tag-size", "0.1", "--output", path("m.yaml")}),
              EndsWith(1, says));
  EXPECT_THAT(run_program({"track", input, "--output", path("o.tum")}), EndsWith(1, says));
  EXPECT_THAT(run_program({"track", input, "--method", "pnp", "--output", path("o.tum")}), EndsWith(1, says));
}

TEST_F(Doctor, NamesTheFamilyOfMirroredPictures) {
  film(4, mirrored(paint({{"tag25h9", 1, 0}, {"tag25h9", 2, 1}})));
  const ProgramRun doctor = run_program({"doctor", folder_.string()});
  EXPECT_EQ(doctor.status, 1);
  EXPECT_THAT(doctor.out,
              HasSubstr("the pictures are mirrored: tags are read in their mirror image (tag25h9/1 and "
                        "1 more), and these are no tag36h11: give --family tag25h9; turn mirroring"));
  EXPECT_EQ(doctor.out.find("no tag of"), std::string::npos) << doctor.out;
}

TEST_F(Doctor, TellsThatSomePicturesAreMirrored) {
  film(6, paint(kThreeTags));
  film(6, mirrored(paint(kThreeTags)));
  const ProgramRun doctor = look();
  EXPECT_EQ(doctor.status, 0);
  EXPECT_THAT(doctor.err,
              HasSubstr("some pictures, though not all, are mirrored: tags are read in their mirror "
                        "image (tag36h11/1 and 2 more)"));
}

TEST_F(Doctor, TakesFramesWithoutTagsForNoMirrorImages) {
  film(6, paint(kThreeTags));
  film(6, paint({}));
  const ProgramRun doctor = look();
  EXPECT_EQ(doctor.err.find("mirror"), std::string::npos) << doctor.err;
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

/// Of `picture`, with numbers from `black` on, `per_level` apart.
void write_sixteen_bits(const fs::path& file, const GrayImage& picture, int black, int per_level) {
  // Binary PGM with 65535 as the largest value: as little known of its bits as of a PNG file's.
  std::string bytes = fmt::format("P5\n{} {}\n65535\n", picture.width(), picture.height());
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      const int value = black + per_level * picture(x, y);
      bytes += static_cast<char>(value >> 8);
      bytes += static_cast<char>(value & 0xFF);
    }
  }
  write_text(file, bytes);
}

TEST_F(Doctor, AndDetectReadTenBitsAndTemperatures) {
  for (const auto& [black, says] : {std::pair(0, "10 bits (0 to 1023)"), {7000, "the range 6"}}) {
    for (int i = 0; i < 3; ++i)
      write_sixteen_bits(folder_ / "frames" / (std::to_string(1'000'000'000 + 100'000'000LL * i) + ".pgm"),
                         seen_in_passing(paint(kThreeTags), i), black, 4);
    EXPECT_THAT(look().out, HasSubstr("all 3 tags are joined"));
    const ProgramRun run = run_program({"detect", folder_.string(), "--json", "--output", path("d.csv")});
    ASSERT_EQ(run.status, 0) << run.err;
    EXPECT_THAT(run.err, HasSubstr(says));
    const auto told = nlohmann::json::parse(run.out);
    EXPECT_EQ(told["detections"], 9);
    EXPECT_EQ(told["readings_left_out"], nlohmann::json::array());
  }
  EXPECT_THAT(look({"--bits", "16"}).out, HasSubstr("no tag of tag36h11")) << "which is as dark as it says";
  EXPECT_THAT(look({"--bits", "17"}), EndsWith(2, "--bits"));
}

TEST_F(Doctor, AndDetectFindTagsThatThePictureCuts) {
  // The pictures end here and there within the first tag's border: where there is enough of it the tag is
  // read, and its pattern says where its edge lies.
  const GrayImage whole = paint(kThreeTags);
  for (int i = 0; i < 16; ++i) {
    const int cut_px = 44 + i;
    GrayImage cut(whole.width() - cut_px, whole.height());
    for (int y = 0; y < cut.height(); ++y) std::copy_n(whole.row(y) + cut_px, cut.width(), cut.row(y));
    write_image(folder_ / "frames" / (std::to_string(1'000'000'000LL * (i + 1)) + ".png"), cut.view());
  }
  const ProgramRun run = run_program({"detect", folder_ / "frames", "--json", "--output", path("d.csv")});
  ASSERT_EQ(run.status, 0) << run.err;
  const auto told = nlohmann::json::parse(run.out);
  EXPECT_GE(told["detections"], 2 * 16 + 3) << run.out;
  EXPECT_EQ(told["readings_left_out"], nlohmann::json::array());
}

TEST_F(Doctor, AndDetectTellOfTagsThatWereReadAndLeftOut) {
  // The library reads the first tag in grey levels below 132, which are all the same light by this response.
  GrayImage picture = paint(kThreeTags);
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x)
      picture(x, y) = static_cast<std::uint8_t>((x < 155 ? 0.0 : 130.0) + 0.55 * picture(x, y));
  std::string table;
  for (int code = 0; code < 256; ++code) table += std::to_string(std::max(code, 132) / 255.0) + "\n";
  write_text(path("light.txt"), table);
  std::string camera = kCamera;
  camera.replace(camera.find("linear"), std::string("linear").size(), "light.txt");
  write_text(path("camera.yaml"), camera);
  film(4, picture);

  const ProgramRun run = run_program({"detect", folder_.string(), "--json", "--output", path("d.csv")});
  ASSERT_EQ(run.status, 0) << run.err;
  const auto told = nlohmann::json::parse(run.out);
  EXPECT_EQ(told["detections"], 2 * 4);
  ASSERT_EQ(told["readings_left_out"].size(), 1U) << run.out;
  EXPECT_EQ(told["readings_left_out"][0]["reason"], "edges_not_fitted");
  EXPECT_EQ(told["readings_left_out"][0]["readings"], 4);
  EXPECT_EQ(told["readings_left_out"][0]["tags"], nlohmann::json::array({"tag36h11/1"}));
  const ProgramRun doctor = look();
  EXPECT_THAT(doctor.out, HasSubstr("(tag36h11/1) w"));
  EXPECT_THAT(doctor.out, HasSubstr(" left out because the edges could not be fitted"));
}

}  // namespace
}  // namespace apriltrack::test
