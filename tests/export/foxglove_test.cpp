// Foxglove's messages, member by member; the official schemas judge a whole run in tests/system.
#include "apriltrack/export/foxglove.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "apriltrack/base/error.h"
#include "support/error_message.h"

namespace apriltrack::test {
namespace {

using nlohmann::json;

constexpr Timestamp kTime{1'700'000'001'000'000'002};
const json kTimeJson = {{"sec", 1700000001}, {"nsec", 2}};

TEST(Foxglove, TransformsArePosesOfTheChildInTheParent) {
  const Pose T_world_camera(Eigen::Quaterniond(0.8, 0.0, 0.6, 0.0), {1.5, -2.25, 0.1});
  const json message = json::parse(frame_transform_json(kTime, "world", "cam0", T_world_camera));
  const json expected = {{"timestamp", kTimeJson},
                         {"parent_frame_id", "world"},
                         {"child_frame_id", "cam0"},
                         {"translation", {{"x", 1.5}, {"y", -2.25}, {"z", 0.1}}},
                         {"rotation", {{"x", 0.0}, {"y", 0.6}, {"z", 0.0}, {"w", 0.8}}}};
  EXPECT_EQ(message, expected);
  const json pose = json::parse(pose_in_frame_json(kTime, "world", T_world_camera));
  EXPECT_EQ(pose["pose"]["position"], expected["translation"]);
  EXPECT_EQ(pose["pose"]["orientation"], expected["rotation"]);
  EXPECT_EQ(pose["frame_id"], "world");
}

Camera camera_with(const Distortion& lens) {
  return {.name = "front",
          .model = CameraModel({500.5, 501.25, 320.75, 239.5}, lens),
          .width = 640,
          .height = 480};
}

TEST(Foxglove, CalibrationsAreOfFoxglovesModels) {
  const json plain = json::parse(camera_calibration_json(kTime, "front", camera_with(NoDistortion())));
  EXPECT_EQ(plain["width"], 640);
  EXPECT_EQ(plain["height"], 480);
  EXPECT_EQ(plain["distortion_model"], "");
  EXPECT_EQ(plain["D"], json::array());
  EXPECT_EQ(plain["K"], (json{500.5, 0.0, 320.75, 0.0, 501.25, 239.5, 0.0, 0.0, 1.0}));
  EXPECT_EQ(plain["P"], (json{500.5, 0.0, 320.75, 0.0, 0.0, 501.25, 239.5, 0.0, 0.0, 0.0, 1.0, 0.0}));
  EXPECT_EQ(plain["R"], (json{1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}));
  const auto lens_of = [](const Distortion& lens) {
    const json message = json::parse(camera_calibration_json(kTime, "front", camera_with(lens)));
    return std::pair(message["distortion_model"].get<std::string>(), message["D"].get<std::vector<double>>());
  };
  using Lens = std::pair<std::string, std::vector<double>>;
  EXPECT_EQ(lens_of(RadtanDistortion({0.1, -0.2, 0.003, -0.004})),
            (Lens{"plumb_bob", {0.1, -0.2, 0.003, -0.004, 0.0}}));
  EXPECT_EQ(lens_of(RadtanDistortion({0.1, -0.2, 0.003, -0.004, 0.05, 0.01, 0.02, 0.03})),
            (Lens{"rational_polynomial", {0.1, -0.2, 0.003, -0.004, 0.05, 0.01, 0.02, 0.03}}));
  EXPECT_EQ(lens_of(EquidistantDistortion({0.1, -0.02, 0.003, -0.0004})),
            (Lens{"kannala_brandt", {0.1, -0.02, 0.003, -0.0004}}));
}

TEST(Foxglove, PicturesAreBase64) {
  // RFC 4648, section 10.
  for (const auto& [bytes, text] : {std::pair<std::string, std::string>{"", ""},
                                    {"f", "Zg=="},
                                    {"fo", "Zm8="},
                                    {"foo", "Zm9v"},
                                    {"foob", "Zm9vYg=="},
                                    {"fooba", "Zm9vYmE="},
                                    {"foobar", "Zm9vYmFy"},
                                    {std::string("\xff\xfe\x00", 3), "//4A"}}) {
    const json message = json::parse(compressed_image_json(kTime, "cam0", bytes, "jpeg"));
    EXPECT_EQ(message["data"], text);
    EXPECT_EQ(message["format"], "jpeg");
  }
}

TEST(Foxglove, OutlinesStandHalfAPixelOn) {
  const std::vector<PictureOutline> outlines = {
      {{{0.0, 0.0}, {10.25, -1.0}, {5.0, 7.0}}, {0.1, 0.2, 0.3, 0.4}, "17"}};
  const json message = json::parse(image_annotations_json(kTime, outlines));
  ASSERT_EQ(message["points"].size(), 1u);
  const json& points = message["points"][0];
  EXPECT_EQ(points["type"], 2);  // LINE_LOOP
  EXPECT_EQ(points["points"],
            (json{{{"x", 0.5}, {"y", 0.5}}, {{"x", 10.75}, {"y", -0.5}}, {{"x", 5.5}, {"y", 7.5}}}));
  EXPECT_EQ(points["outline_color"], (json{{"r", 0.1}, {"g", 0.2}, {"b", 0.3}, {"a", 0.4}}));
  EXPECT_EQ(message["texts"][0]["text"], "17");
  EXPECT_EQ(message["texts"][0]["position"], (json{{"x", 0.5}, {"y", 0.5}}));
}

TEST(Foxglove, ScenesHaveLinesQuadsAndTexts) {
  const SceneEntity entity{.frame = "world",
                           .id = "all",
                           .lines = {{{{0, 0, 0}, {1, 2, 3}}, true, 1.5, {1, 0, 0, 1}}},
                           .quads = {{{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}}, {0, 1, 0, 0.5}},
                                     {{{{0, 0, 5}, {1, 0, 5}, {1, 1, 5}, {0, 1, 5}}}, {0, 0, 1, 0.5}}},
                           .texts = {{{1, 2, 3}, 0.25, {1, 1, 1, 1}, "7"}},
                           .facts = {{"tag36h11/7", "detected"}}};
  const json message = json::parse(scene_update_json(kTime, {&entity, 1}));
  EXPECT_TRUE(message["deletions"].empty());
  const json& drawn = message["entities"][0];
  EXPECT_EQ(drawn["frame_id"], "world");
  EXPECT_EQ(drawn["lifetime"], (json{{"sec", 0}, {"nsec", 0}}));
  EXPECT_EQ(drawn["lines"][0]["type"], 1);  // LINE_LOOP
  EXPECT_EQ(drawn["lines"][0]["points"][1], (json{{"x", 1.0}, {"y", 2.0}, {"z", 3.0}}));
  const json& triangles = drawn["triangles"][0];
  EXPECT_EQ(triangles["points"].size(), 8u);
  EXPECT_EQ(triangles["colors"].size(), 8u);
  EXPECT_EQ(triangles["indices"], (json{0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7}));
  EXPECT_EQ(triangles["points"][6], (json{{"x", 1.0}, {"y", 1.0}, {"z", 5.0}}));
  EXPECT_EQ(triangles["colors"][4], (json{{"r", 0.0}, {"g", 0.0}, {"b", 1.0}, {"a", 0.5}}));
  EXPECT_EQ(drawn["texts"][0]["text"], "7");
  EXPECT_EQ(drawn["metadata"], (json::array({{{"key", "tag36h11/7"}, {"value", "detected"}}})));
  const json empty = json::parse(scene_update_json(kTime, {}));
  EXPECT_EQ(empty["deletions"][0]["type"], 1);  // ALL
}

TEST(Foxglove, TimesBefore1970AreRefused) {
  EXPECT_THAT(message_of([] { pose_in_frame_json({-1}, "world", {}); }),
              testing::HasSubstr("-0.000000001 s: lies before 1970"));
}

TEST(Foxglove, TextsThatAreNoUtf8AreShownAsFarAsTheyAre) {
  const json message = json::parse(log_json(kTime, FoxgloveLevel::kWarning, "track", "caf\xe9 is lost"));
  EXPECT_THAT(message["message"].get<std::string>(), testing::HasSubstr(" is lost"));
  EXPECT_EQ(message["level"], 3);
}

TEST(Foxglove, SchemasAreCalledAsTheyAre) {
  for (int type = 0; type <= static_cast<int>(FoxgloveType::kLog); ++type) {
    const auto known = static_cast<FoxgloveType>(type);
    EXPECT_EQ(json::parse(foxglove_schema(known))["title"], foxglove_schema_name(known));
  }
}

}  // namespace
}  // namespace apriltrack::test
