// What `doctor`, and all commands that detect tags, say of pictures that are mirrored, deep, cut or dark.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>

#include "apriltrack/source/image_file.h"
#include "painted_recording.h"
#include "program.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;
using ::testing::HasSubstr;

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
  std::string camera = kPaintedCamera;
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
