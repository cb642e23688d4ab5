// A camera's response: told by the pictures of tags where nothing states it, and held against them where the
// file does.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detections_csv.h"
#include "apriltrack/sim/named_scenes.h"
#include "apriltrack/sim/renderer.h"
#include "apriltrack/sim/streaks.h"
#include "apriltrack/source/image_file.h"
#include "apriltrack/tags/tag_map.h"
#include "detect/corner_statistics.h"
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
  const ProgramRun few =
      run_program({"calibrate", path("room"), "--camera", path("room/camera.yaml"), "--response", "auto",
                   "--max-frames", "1", "--tag-size", "0.16", "--output", path("few.yaml")});
  EXPECT_THAT(few, EndsWith(1, "too few sharp pictures of tags"));
  write_text(path("d.csv"), "timestamp_ns,camera,family,id,c0x,c0y,c1x,c1y,c2x,c2y,c3x,c3y\n");
  EXPECT_THAT(run_program({"calibrate", "--detections", path("d.csv"), "--camera", camera, "--tag-size",
                           "0.16", "--output", path("m.yaml")}),
              EndsWith(2, "`response: auto`, which is estimated from images"));
}

/// The simulator's room, taken by a camera whose file states no response.
class UnstatedResponse : public ::testing::TestWithParam<const char*> {
 protected:
  static ResponseCurve taken_with() {
    const std::string name = GetParam();
    return name == "linear" ? ResponseCurve::linear()
           : name == "srgb" ? ResponseCurve::srgb()
                            : ResponseCurve::gamma(1.5);
  }

  void SetUp() override {
    folder_ = temporary_folder();
    scene_ = make_scene("room-gentle", {.texel_m = 0.02});
    scene_.num_frames = 16;
    scene_.rate_hz = 2.0;
    scene_.exposure_s = 0.003;
    scene_.camera.response = taken_with();
    const Renderer renderer(scene_, {.seed = 1043});
    fs::create_directories(folder_ / "room" / "frames");
    for (std::size_t i = 0; i < scene_.num_frames; ++i) {
      const RenderedFrame frame = renderer.render(i);
      write_image(folder_ / "room" / "frames" / (std::to_string(frame.timestamp.ns) + ".png"),
                  frame.pixels.view());
    }
    write_camera(ResponseOrigin::kAssumed);
    write_tag_map(folder_ / "room" / "map.yaml", scene_.map);
  }

  void write_camera(ResponseOrigin origin) {
    scene_.camera.response_origin = origin;
    write_cameras(folder_ / "room" / "camera.yaml", {{scene_.camera}});
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  /// The pictures tell gamma 1.5 to a hundredth or two.
  static void expect_used(const nlohmann::json& response) {
    EXPECT_EQ(response.at("origin"), "estimated");
    EXPECT_LT(response.at("sigma").get<double>(), 0.2);
    const std::string used = response.at("used");
    if (taken_with().name().starts_with("gamma:")) {
      ASSERT_TRUE(used.starts_with("gamma:")) << used;
      EXPECT_NEAR(std::stod(used.substr(6)), 1.5, 0.03);
    } else {
      EXPECT_EQ(used, taken_with().name());
    }
  }

  fs::path folder_;
  Scene scene_;
};

TEST_P(UnstatedResponse, LeavesCornersWhereTheyAre) {
  const nlohmann::json summary = run_for_json({"detect", path("room"), "--output", path("d.csv")});
  expect_used(summary.at("response"));
  const nlohmann::json looked = run_for_json({"doctor", path("room"), "--no-other-families"});
  expect_used(looked.at("recordings").at(0).at("response"));
  std::size_t seen = 0;
  for (const nlohmann::json& tag : looked.at("tags")) seen += tag.at("frames").get<std::size_t>();
  EXPECT_EQ(seen, summary.at("detections")) << "doctor and detect see the same tags";
  write_camera(ResponseOrigin::kStated);
  const nlohmann::json stated = run_for_json({"detect", path("room"), "--output", path("s.csv")});
  EXPECT_EQ(stated.at("response").at("origin"), "stated");
  EXPECT_EQ(summary.at("detections"), stated.at("detections")) << "as many as where the file states it";
  CornerStatistics errors;
  for (const FrameDetections& frame : read_detections_csv(path("d.csv"))) {
    for (const TagView& view : tag_views(scene_, frame.timestamp)) {
      const auto found = std::ranges::find(frame.detections, view.key, &Detection::tag);
      if (view.blur_px < 2.0 && found != frame.detections.end())
        errors.add(found->corners_px, view.corners_px);
    }
  }
  ASSERT_GE(errors.num_tags(), 20);
  EXPECT_LE(std::abs(errors.radial_bias_px()), kMaxBias_px);
}

TEST_P(UnstatedResponse, LeavesTheMapItsScale) {
  const nlohmann::json summary = run_for_json({"calibrate", path("room"), "--tag-size", "0.16", "--min-views",
                                               "2", "--no-refine", "--output", path("map.yaml")});
  expect_used(summary.at("responses").at(0));
  const bool is_srgb = taken_with().name() == "srgb";  // what is taken where nothing is known
  EXPECT_EQ(fs::exists(path("map.camera.yaml")), !is_srgb);
  if (!is_srgb) {
    const Camera written = read_cameras(path("map.camera.yaml")).cameras.front();
    EXPECT_EQ(written.response.name(), summary.at("responses").at(0).at("used").get<std::string>());
  }
  const TagMap map = read_tag_map(path("map.yaml"));
  double found_m = 0.0, true_m = 0.0;
  for (const MapTag& a : map.tags) {
    for (const MapTag& b : map.tags) {
      const auto distance = [](const MapTag& one, const MapTag& other) {
        return (one.T_map_tag.translation() - other.T_map_tag.translation()).norm();
      };
      found_m += distance(a, b);
      true_m += distance(*scene_.map.find(a.key), *scene_.map.find(b.key));
    }
  }
  ASSERT_GE(map.tags.size(), 6U);
  EXPECT_NEAR(found_m / true_m, 1.0, 0.002);
}

TEST_P(UnstatedResponse, IsUsedForTracking) {
  const nlohmann::json summary = run_for_json({"track", path("room"), "--output", path("t.tum")});
  expect_used(summary.at("response"));
}

/// A sample looks at every third frame at most.
TEST_P(UnstatedResponse, IsToldByAllTagsWhereASampleShowsNone) {
  constexpr std::size_t kNumFrames = 96;
  const fs::path folder = folder_ / "seldom";
  fs::create_directories(folder / "frames");
  fs::copy(folder_ / "room" / "camera.yaml", folder / "camera.yaml");
  GrayImage wall(scene_.camera.width, scene_.camera.height);
  for (int y = 0; y < wall.height(); ++y)
    for (int x = 0; x < wall.width(); ++x) wall(x, y) = static_cast<std::uint8_t>(120 + (x / 8 + y / 8) % 2);
  auto tagged = fs::directory_iterator(folder_ / "room" / "frames");
  std::vector<fs::path> pictures(begin(tagged), end(tagged));
  std::ranges::sort(pictures);
  for (std::size_t i = 0; i < kNumFrames; ++i) {
    const fs::path file = folder / "frames" / (std::to_string(1'000'000'000 + 100'000'000 * i) + ".png");
    const std::size_t next = i / 3 * 2 + i % 3 - 1;
    if (i % 3 != 0 && next < pictures.size())
      fs::copy(pictures[next], file);
    else
      write_image(file, wall.view());
  }
  const nlohmann::json detected = run_for_json({"detect", folder, "--output", path("seldom.csv")});
  expect_used(detected.at("response"));
  EXPECT_GT(detected.at("response").at("frames"), 6) << "these are no frames of the sample";
  const nlohmann::json calibrated = run_for_json({"calibrate", folder, "--tag-size", "0.16", "--min-views",
                                                  "2", "--no-refine", "--output", path("seldom.yaml")});
  expect_used(calibrated.at("responses").at(0));
}

INSTANTIATE_TEST_SUITE_P(Takes, UnstatedResponse, ::testing::Values("linear", "srgb", "gamma"),
                         [](const auto& one) { return std::string(one.param); });

TEST_F(Response, IsContradictedInDetectAndDoctorToo) {
  simulate(16);
  const std::string camera = camera_with("linear");
  const ProgramRun detected =
      run_program({"detect", path("room"), "--camera", camera, "--output", path("d.csv")});
  EXPECT_EQ(detected.status, 0);
  EXPECT_THAT(detected.err, HasSubstr("its response is not linear as taken for it"));
  const ProgramRun looked = run_program({"doctor", path("room"), "--camera", camera, "--no-other-families"});
  EXPECT_THAT(looked.err, HasSubstr("its response is not linear as taken for it"));
}

TEST_F(Response, IsInDoubtWherePicturesCannotTell) {
  simulate(1);
  std::string text = read_text(folder_ / "room" / "camera.yaml");
  text.erase(text.find("  response: srgb\n"), 17);
  write_text(folder_ / "camera.yaml", text);
  const ProgramRun detected =
      run_program({"detect", path("room"), "--camera", path("camera.yaml"), "--output", path("d.csv")});
  EXPECT_EQ(detected.status, 0);
  EXPECT_THAT(detected.err, HasSubstr("its response is in doubt: the camera file states none, and too few"));
  EXPECT_THAT(detected.out, HasSubstr("response: sRGB, assumed"));
}

/// 16-bit pictures of a sensor's own values, of a grid whose tags hang together.
TEST(ResponseOfMachineVision, IsToldByOnePicture) {
  APRILTRACK_SHARED_OR_SKIP(folder, "cases/linear_16bit_grid");
  const std::string image = (folder / "1000000000.png").string();
  const std::string output = (temporary_folder() / "d.csv").string();
  const nlohmann::json summary =
      run_for_json({"detect", image, "--rate", "1", "--family", "tag36h11b2", "--output", output});
  EXPECT_EQ(summary.at("detections"), 36);
  EXPECT_EQ(summary.at("response").at("used"), "linear");
  EXPECT_EQ(summary.at("value_range"), (nlohmann::json{{"black", 0}, {"white", 65535}, {"bits", 16}}));
  const ProgramRun doctor = run_program({"doctor", image, "--rate", "1", "--family", "tag36h11b2",
                                         "--no-other-families", "--json"});  // one picture makes no map
  const nlohmann::json looked = nlohmann::json::parse(doctor.out);
  EXPECT_EQ(looked.at("tags").size(), 36U);
  EXPECT_EQ(looked.at("recordings").at(0).at("response").at("used"), "linear");
}

}  // namespace
}  // namespace apriltrack::test
