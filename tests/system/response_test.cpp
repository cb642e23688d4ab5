// A camera's response: estimated where it is asked for, and held against the pictures where it is not.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "apriltrack/camera/camera.h"
#include "program.h"
#include "read_report.h"
#include "support/shared_data.h"
#include "wpilib_camera.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;
using Words = std::vector<std::string>;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

/// The simulator's pictures are sRGB.
class Response : public ::testing::Test {
 protected:
  void SetUp() override { folder_ = temporary_folder(); }
  void simulate(int frames) const {
    run_for_json({"simulate", "--scene", "room-gentle", "--frames", std::to_string(frames), "--rate", "2",
                  "--exposure", "0.003", "--output", path("room")});
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  std::string camera_with(const std::string& response) const {
    std::string text = read_text(folder_ / "room" / "camera.yaml");
    text.replace(text.find("response: srgb"), 14, "response: " + response);
    write_text(folder_ / "camera.yaml", text);
    return path("camera.yaml");
  }
  Words calibrate(const std::string& camera) const {
    return {"calibrate", path("room"),  "--camera", camera,     "--tag-size",
            "0.16",      "--min-views", "2",        "--output", path("map.yaml")};
  }

  fs::path folder_;
};

TEST_F(Response, IsEstimatedAndWrittenForTrack) {
  simulate(16);
  const nlohmann::json summary = run_for_json(calibrate(camera_with("auto")));
  const nlohmann::json& response = summary.at("responses").at(0);
  EXPECT_EQ(response.at("used"), "srgb");
  EXPECT_NEAR(response.at("exponent").get<double>(), 2.25, 0.1);
  EXPECT_LT(response.at("sigma").get<double>(), 0.12);
  EXPECT_EQ(summary.at("camera"), path("map.camera.yaml"));
  EXPECT_EQ(read_cameras(path("map.camera.yaml")).cameras.front().response.name(), "srgb");
  EXPECT_THAT(read_text(path("map.yaml")), HasSubstr("of cam0 estimated: srgb"));
}

TEST_F(Response, IsDoubtedWherePicturesSayOtherwise) {
  simulate(16);
  const ProgramRun wrong = run_program(calibrate(camera_with("linear")));
  EXPECT_EQ(wrong.status, 0);
  EXPECT_THAT(wrong.err, HasSubstr("its response is not linear as taken for it"));
  EXPECT_THAT(wrong.err, HasSubstr("`response: srgb`"));
  EXPECT_FALSE(fs::exists(path("map.camera.yaml")));
  EXPECT_THAT(run_program(calibrate(camera_with("srgb"))).err, Not(HasSubstr("response")));
}

TEST_F(Response, IsToldInTheReport) {
  simulate(16);
  const auto row_of = [&](const std::string& response) {
    Words words = calibrate(camera_with(response));
    words.insert(words.end(), {"--report", path("page.html")});
    run_for_json(words);
    const ReadReport page(path("page.html"));
    EXPECT_THAT(page.texts("h2"), Contains("The response of the cameras"));
    return page.row("cam0");
  };
  const auto wrong = row_of("linear");
  ASSERT_EQ(wrong.size(), 5U);
  EXPECT_EQ(wrong[0], "linear");
  EXPECT_NEAR(numbers_in(wrong[1])[0], 2.25, 0.1);
  EXPECT_EQ(wrong[4], "wrong: the pictures say srgb");
  EXPECT_EQ(row_of("srgb").back(), "the pictures agree");
  const auto estimated = row_of("auto");
  EXPECT_EQ(estimated[0], "srgb");
  EXPECT_EQ(estimated.back(), "estimated from them, as was asked for");
}

TEST_F(Response, IsEstimatedOfACameraFileWithoutAResolution) {
  simulate(16);
  const Camera camera = read_cameras(path("room/camera.yaml")).cameras.front();
  write_text(path("camera.json"), wpilib_text(camera.model));
  Words words = calibrate(path("camera.json"));
  words.insert(words.end(), {"--response", "auto"});
  run_for_json(words);
  const Camera written = read_cameras(path("map.camera.yaml")).cameras.front();
  EXPECT_EQ(written.response.name(), "srgb");
  EXPECT_EQ(written.width, camera.width);
  EXPECT_EQ(written.height, camera.height);
}

TEST_F(Response, AutoNeedsPictures) {
  simulate(4);
  const std::string camera = camera_with("auto");
  const ProgramRun tracked = run_program(
      {"track", path("room"), "--camera", camera, "--map", path("room/map.yaml"), "--output", path("t.tum")});
  EXPECT_THAT(tracked, EndsWith(2, "cam0.response: 'auto': `apriltrack calibrate` estimates"));
  const ProgramRun few =
      run_program({"calibrate", path("room"), "--camera", path("room/camera.yaml"), "--response", "auto",
                   "--max-frames", "4", "--tag-size", "0.16", "--output", path("few.yaml")});
  EXPECT_THAT(few, EndsWith(1, "too few sharp pictures of tags"));
  write_text(path("d.csv"), "timestamp_ns,camera,family,id,c0x,c0y,c1x,c1y,c2x,c2y,c3x,c3y\n");
  EXPECT_THAT(run_program({"calibrate", "--detections", path("d.csv"), "--camera", camera, "--tag-size",
                           "0.16", "--output", path("m.yaml")}),
              EndsWith(2, "`response: auto`, which is estimated from images"));
}

}  // namespace
}  // namespace apriltrack::test
