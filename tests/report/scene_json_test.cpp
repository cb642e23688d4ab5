// A scene's data in a page, against numbers that are written out by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "apriltrack/base/check.h"
#include "apriltrack/report/html_page.h"
#include "apriltrack/report/scene_view.h"
#include "page_elements.h"

namespace apriltrack {
namespace {

using nlohmann::json;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

const std::string kEvil = "</script><!--<script>&\"'\xFF";

/// Three by three cells: black where the sum of row and column is odd, nothing printed in the last corner.
Image<float> small_cells() {
  Image<float> cells(3, 3);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) cells(column, row) = (row + column) % 2 == 1 ? 0.0F : 1.0F;
  }
  cells(2, 2) = std::numeric_limits<float>::quiet_NaN();
  return cells;
}

SceneView small_scene() {
  SceneView scene;
  scene.up = {0.0, -1.0, 0.0};
  scene.tag_states = {{"of the map"}, {"left out", SvgInk::kPurpleInk, true}};
  SceneTag tag;
  tag.name = kEvil;
  tag.label = "7";
  tag.family = "small";
  tag.cells = small_cells();
  tag.width_at_border = 1;
  tag.pose = {{1.2345678, -2.0, 0.0}, Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5)};
  tag.size_m = 0.16;
  Eigen::Matrix3d covariance;
  covariance << 4.0e-6, 1.23456e-7, 0.0, 1.23456e-7, 9.0e-6, -5.0e-8, 0.0, -5.0e-8, 1.0e-6;
  tag.covariance_m2 = covariance;
  tag.state = 1;
  scene.tags = {tag};
  scene.ellipsoid_scale = 50.0;
  scene.motion = SceneMotion::kCamera;
  scene.path_states = {{"detected", SvgInk::kGreenInk}, {"lost", SvgInk::kVermilionInk}};
  scene.path = {{0.0, ScenePose{{3.0, 4.0, 5.0}, Eigen::Quaterniond::Identity()}, 0},
                {0.0333333, std::nullopt, 1}};
  return scene;
}

TEST(SceneJson, HoldsWhatTheSceneIs) {
  const json scene = json::parse(scene_json(small_scene()));
  EXPECT_EQ(scene["moving"], "camera");
  EXPECT_EQ(scene["up"], json({0.0, -1.0, 0.0}));
  EXPECT_EQ(scene["ellipsoid_scale"], 50.0);
  const json& tag = scene["tags"][0];
  EXPECT_EQ(tag["label"], "7");
  EXPECT_EQ(tag["position_m"], json({1.23457, -2.0, 0.0}));
  EXPECT_EQ(tag["orientation_xyzw"], json({0.5, -0.5, 0.5, 0.5}));
  EXPECT_EQ(tag["size_m"], 0.16);
  EXPECT_EQ(tag["covariance_m2"], json({4.0e-6, 1.235e-7, 0.0, 9.0e-6, -5.0e-8, 1.0e-6}));
  // 010 101 01. in fours: 0101 0101 0 and three that are not there.
  EXPECT_EQ(tag["black"], "550");
  EXPECT_EQ(scene["families"][0], json({{"name", "small"}, {"cells", 3}, {"cells_across_size", 1}}));
  EXPECT_EQ(scene["tag_states"][1],
            json({{"name", "left out"}, {"colour", "--purple"}, {"is_crossed", true}}));
  EXPECT_EQ(scene["path"]["time_s"], json({0.0, 0.0333}));
  EXPECT_EQ(scene["path"]["state"], json({0, 1}));
  EXPECT_EQ(scene["path"]["position_m"], json({3.0, 4.0, 5.0, nullptr, nullptr, nullptr}));
  EXPECT_FALSE(scene.contains("true_path"));
}

TEST(SceneJson, NoNameEndsTheScript) {
  const std::string text = scene_json(small_scene());
  for (const char* part : {"<", ">", "&"}) EXPECT_THAT(text, Not(HasSubstr(part)));
  const std::string name = json::parse(text)["tags"][0]["name"];
  EXPECT_THAT(name, HasSubstr("</script><!--<script>&\"'"));
}

TEST(SceneJson, LongPathsAreThinnedEvenly) {
  EXPECT_EQ(path_stride(5000), 1U);
  EXPECT_EQ(path_stride(5001), 2U);
  SceneView scene = small_scene();
  scene.path.clear();
  for (int i = 0; i < 12'000; ++i) scene.path.push_back({0.1 * i, std::nullopt, 0});
  const json shown = json::parse(scene_json(scene))["path"]["time_s"];
  ASSERT_EQ(shown.size(), 4000U);
  EXPECT_EQ(shown[1], 0.3);
}

TEST(SceneJson, FiveHundredTagsTakeTwoHundredKilobytesAtMost) {
  SceneView scene = small_scene();
  scene.tags[0].name = "tag36h11/7";
  Image<float> cells(10, 10);
  for (int i = 0; i < 100; ++i) cells(i % 10, i / 10) = i % 3 == 0 ? 0.0F : 1.0F;
  scene.tags[0].cells = cells;
  scene.tags.resize(500, scene.tags[0]);
  EXPECT_LT(scene_json(scene).size(), 200'000U);
}

TEST(SceneJson, RefusesWhatCannotBeDrawn) {
  SceneView scene = small_scene();
  scene.tags[0].state = 2;
  EXPECT_THROW(scene_json(scene), MisuseError);
  scene = small_scene();
  scene.path[0].state = 2;
  EXPECT_THROW(scene_json(scene), MisuseError);
  scene = small_scene();
  scene.tags[0].pose.position_m.x() = std::numeric_limits<double>::infinity();
  EXPECT_THROW(scene_json(scene), MisuseError);
  scene = small_scene();
  scene.tags.push_back(scene.tags[0]);
  scene.tags[1].cells = Image<float>(4, 4);
  EXPECT_THROW(scene_json(scene), MisuseError);
}

TEST(ScenePage, IsStillXmlAndHasOneScriptForAllScenes) {
  HtmlPage page("title");
  page.scene(small_scene(), "a <scene>");
  page.scene(small_scene(), "another");
  const auto lines = test::elements_of(page);
  EXPECT_EQ(
      std::ranges::count_if(lines, [](const std::string& line) { return line.starts_with("script||"); }), 1);
  EXPECT_EQ(
      std::ranges::count_if(
          lines, [](const std::string& line) { return line.starts_with("script|type=application/json|"); }),
      2);
  EXPECT_THAT(lines, Contains("figcaption||a <scene>"));
  EXPECT_THAT(page.html(), HasSubstr("MIT License"));
}

TEST(ScenePage, PagesWithoutASceneHaveNoScript) {
  HtmlPage page("title");
  page.paragraph("words");
  EXPECT_THAT(page.html(), Not(HasSubstr("<script")));
  EXPECT_THAT(page.html(), HasSubstr("default-src 'none'"));
}

}  // namespace
}  // namespace apriltrack
