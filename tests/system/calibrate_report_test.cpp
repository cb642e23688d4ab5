// `calibrate --report`, `--cross-validate` and `--joint-covariance`: what they say is what the map says, and
// what is known of the films by construction.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "apriltrack/tags/tag_map.h"
#include "filmed_wall.h"
#include "program.h"
#include "read_report.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsSupersetOf;
using testing::Not;

class CalibrateReport : public ::testing::Test {
 protected:
  void SetUp() override { write_text(path("camera.yaml"), pinhole_entry("cam0")); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  struct Take {
    int frames = 0;
    std::vector<int> ids;
  };
  /// Ten frames a second; rounded to a hundredth of a pixel, so that there is something to be left over.
  void film(const std::vector<Take>& takes) const {
    std::string csv = kDetectionsHeader;
    long long time_ns = 1'000'000'000;
    for (const Take& take : takes) {
      for (int view = 0; view < take.frames; ++view) {
        time_ns += 100'000'000;
        for (const int id : take.ids) csv += wall_row(time_ns, camera_from_wall(view), id);
      }
    }
    write_text(path(kCorners), csv);
  }

  std::vector<std::string> words(const std::vector<std::string>& more,
                                 const std::string& camera = "camera.yaml") const {
    std::vector<std::string> all = {"calibrate", "--detections", path(kCorners),
                                    "--camera",  path(camera),   "--tag-size",
                                    "0.16",      "--output",     path("map.yaml")};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }

  static constexpr const char* kCorners = "a<b>&\"c'.csv";
  const fs::path folder_ = temporary_folder();
};

/// Of all tags' outlines in a picture, in its units.
double height_of_outline(const std::string& source, const std::string& picture) {
  const std::size_t name = source.find(">" + picture + "<"), begin = source.rfind("<svg", name);
  double low = 1e9, high = -1e9;
  for (std::size_t at = source.find("<polygon", begin); at < name; at = source.find("<polygon", at + 1)) {
    if (source[source.find('>', at) - 1] == '/') continue;  // an arrow's head, which has no tooltip
    const std::size_t points = source.find("points=\"", at) + 8;
    const std::vector<double> numbers =
        numbers_in(source.substr(points, source.find('"', points + 1) - points));
    for (std::size_t i = 1; i < numbers.size(); i += 2) {
      low = std::min(low, numbers[i]);
      high = std::max(high, numbers[i]);
    }
  }
  return high - low;
}

TEST_F(CalibrateReport, HasAllSectionsAndTheMapsFigures) {
  film({{40, {0, 1, 2}}});
  const nlohmann::json summary = run_for_json(words({"--report", path("page.html")}));
  EXPECT_EQ(summary["report"], path("page.html"));
  const ReadReport page(path("page.html"));
  EXPECT_THAT(page.texts("h1"), ElementsAre("Calibration report: " + path(kCorners)));
  EXPECT_THAT(page.texts("h2"),
              IsSupersetOf({"In short", "What is weak, and what would help", "Tag by tag",
                            "How the tags hang together", "The recording's two halves against each other",
                            "What the corners leave over", "Cameras", "How it was made"}));
  EXPECT_THAT(page.texts("text"),
              IsSupersetOf({"From above", "From the front", "From the right", "cam0", "0", "1", "2"}));
  EXPECT_EQ(page.texts("svg").size(), 6U) << "above, two sides, links, residuals, their histogram";
  EXPECT_THAT(page.texts("p"), Contains(HasSubstr("3 tags are in the map, from 40 of 40 frames")));
  const TagMap map = read_tag_map(path("map.yaml"));
  for (const MapTag& tag : map.tags) {
    const auto cells = page.row(to_string(tag.key));
    ASSERT_EQ(cells.size(), 11U);
    EXPECT_EQ(cells[1], fmt::format("{}", tag.statistics->views));
    EXPECT_NEAR(numbers_in(cells[4])[0], 1e3 * std::sqrt(tag.covariance->topLeftCorner<3, 3>().trace()),
                0.0051);
  }
}

TEST_F(CalibrateReport, NeedsNothingBesideItself) {
  film({{40, {0, 1, 2}}});
  run_for_json(words({"--report", path("page.html")}));
  const ReadReport page(path("page.html"));
  for (const char* reference : {"http:", "https:", "href", "<link", "@import", "url(", "<iframe", "src="})
    EXPECT_THAT(page.source(), Not(HasSubstr(reference)));
}

TEST_F(CalibrateReport, TellsMachinesOfHangingPartsAndHalves) {
  film({{30, {0, 1}}, {30, {2, 11}}, {3, {1, 2}}});
  const nlohmann::json summary = run_for_json(words({"--cross-validate", "--report", path("page.html")}));
  ASSERT_EQ(summary["hanging"].size(), 1U);
  EXPECT_EQ(summary["hanging"][0]["frames"], 3);
  EXPECT_EQ(summary["hanging"][0]["tags"].size(), 2U);
  EXPECT_TRUE(summary["weak_directions"].is_array());
  EXPECT_TRUE(summary["advice"].is_array());
  EXPECT_TRUE(summary["joining"].empty());
  EXPECT_TRUE(summary.contains("cross_validation"));
  const std::string words_told = summary["hanging"][0]["text"];
  EXPECT_THAT(words_told, HasSubstr("hang on the rest by 3 frames only"));
  const ReadReport page(path("page.html"));
  EXPECT_THAT(page.texts("p").front(), HasSubstr(words_told)) << "warnings first";

  film({{40, {0, 1, 2}}});
  const nlohmann::json plain = run_for_json(words({}));
  EXPECT_FALSE(plain.contains("cross_validation")) << "it costs two more solutions";
  EXPECT_TRUE(plain["hanging"].empty());
  const nlohmann::json halves = run_for_json(words({"--cross-validate"}))["cross_validation"];
  EXPECT_LT(halves["normalised_error_squared"], 2.0);
  EXPECT_EQ(halves["tags"].size(), 2U);
  EXPECT_EQ(halves["moments"][0].get<int>() + halves["moments"][1].get<int>(), 40);
}

TEST_F(CalibrateReport, ShowsPartsAndSaysWhatWouldJoinThem) {
  film({{30, {0, 1, 2}}, {20, {10, 11}}});
  const nlohmann::json summary = run_for_json(words({"--report", path("page.html")}));
  ASSERT_EQ(summary["joining"].size(), 1U);
  EXPECT_EQ(summary["joining"][0]["joins"], (nlohmann::json{"tag36h11/10", "tag36h11/11"}));
  const ReadReport page(path("page.html"));
  EXPECT_THAT(page.texts("h2"), Contains("A part of its own: 2 tags"));
  EXPECT_THAT(page.texts("p").front(), HasSubstr("a part of its own, not in the map"));
  EXPECT_TRUE(page.has_row("tag36h11/10"));
  EXPECT_THAT(page.texts("li"), Contains(HasSubstr("that joins tag36h11/10, tag36h11/11 to the map")));
}

TEST_F(CalibrateReport, OfARunWithoutAMapSaysWhyBesideOneThatHadAMap) {
  write_text(path("page.html"), "of an earlier run");
  film({{10, {0}}, {10, {1}}});
  EXPECT_THAT(run_program(words({"--report", path("page.html")})), EndsWith(1, "no two tags connect"));
  EXPECT_FALSE(fs::exists(path("map.yaml")));
  EXPECT_EQ(read_text(path("page.html")), "of an earlier run");
  const ReadReport page(path("page.no_map.html"));
  EXPECT_THAT(page.texts("h2"), Contains("No map"));
  EXPECT_THAT(page.texts("p"), Contains(AllOf(HasSubstr("no two tags connect"), HasSubstr("in a chain"))));
  EXPECT_THAT(page.texts("code"), Contains(HasSubstr("calibrate --detections")));
  film({{40, {0, 1, 2}}});
  EXPECT_THAT(run_for_json(words({"--report", path("page.html")}))["warnings"],
              Contains(AllOf(HasSubstr("page.no_map.html"), HasSubstr("of an earlier run"))));
}

TEST_F(CalibrateReport, IsCheckedBeforeTheWork) {
  film({{40, {0, 1, 2}}});
  for (const char* option : {"--report", "--joint-covariance"}) {
    EXPECT_THAT(run_program(words({option, path("nowhere/file")})), EndsWith(3, "nowhere"));
    EXPECT_THAT(run_program(words({option, path("map.yaml")})), EndsWith(2, "is the file of --output"));
    EXPECT_THAT(run_program(words({option, path("camera.yaml")})), EndsWith(2, "is an input of this run"));
  }
  EXPECT_FALSE(fs::exists(path("map.yaml")));
}

TEST_F(CalibrateReport, DrawsNoWayFromOneTakeToTheNext) {
  film({{20, {0, 1, 2}}});
  std::string again = kDetectionsHeader;
  for (int view = 20; view < 40; ++view) {
    for (const int id : {0, 1, 2}) again += wall_row(100'000'000LL * (view - 9), camera_from_wall(view), id);
  }
  write_text(path("again.csv"), again);
  const auto paths_drawn = [&](const std::vector<std::string>& more) {
    run_for_json(words(more));
    const std::string source = ReadReport(path("page.html")).source();
    const std::size_t below = source.find("From above"), above = source.rfind("<svg", below);
    std::size_t count = 0;
    for (std::size_t at = source.find("<polyline", above); at < below; at = source.find("<polyline", at + 1))
      ++count;
    return count;
  };
  EXPECT_EQ(paths_drawn({"--report", path("page.html")}), 1U);
  EXPECT_EQ(paths_drawn({"--report", path("page.html"), "--detections", path("again.csv")}), 2U);
}

TEST_F(CalibrateReport, DrawsATagThatIsLeftOutWhereItHangs) {
  film({{40, {0, 1, 2}}, {1, {0, 1, 2, 11}}});  // seen once, which is too seldom for the map
  const nlohmann::json told = run_for_json(words({"--report", path("page.html")}));
  ASSERT_EQ(told["left_out"], nlohmann::json{"tag36h11/11"});
  const ReadReport page(path("page.html"));
  const nlohmann::json scene = nlohmann::json::parse(page.texts("script").at(0));
  const auto tag =
      std::ranges::find_if(scene["tags"], [](const nlohmann::json& one) { return one["label"] == "11"; });
  ASSERT_NE(tag, scene["tags"].end());
  EXPECT_EQ(scene["tag_states"][(*tag)["state"].get<std::size_t>()]["name"], "left out");
  // Tag 0 is held at the origin; corners are of a hundredth of a pixel.
  for (Eigen::Index i = 0; i < 3; ++i)
    EXPECT_NEAR((*tag)["position_m"][static_cast<std::size_t>(i)].get<double>(), kWallPlaces_m.at(11)[i],
                2e-3);
  EXPECT_THAT(page.texts("text"), Contains("11"));
  EXPECT_THAT(page.texts("figcaption"), Contains(HasSubstr("left out of the map")));
}

TEST_F(CalibrateReport, HasOneScaleOfEllipses) {
  film({{40, {0, 1, 2}}});
  run_for_json(words({"--report", path("page.html")}));
  const ReadReport page(path("page.html"));
  const nlohmann::json scene = nlohmann::json::parse(page.texts("script").at(0));
  const std::string scale = fmt::format("drawn {:g} times too large", scene["ellipsoid_scale"].get<double>());
  std::size_t told = 0;
  for (const std::string& caption : page.texts("figcaption")) {
    told += caption.find(scale) != std::string::npos;
    EXPECT_EQ(caption.find("times too large") == std::string::npos, caption.find(scale) == std::string::npos)
        << caption;
  }
  EXPECT_EQ(told, 1U);
}

TEST_F(CalibrateReport, OfAMeasuredFrameHoldsNoTagAndHasItsUp) {
  film({{40, {0, 1, 2}}});
  const auto caption = [&](const std::vector<std::string>& more) {
    run_for_json(words(more));
    for (const std::string& text : ReadReport(path("page.html")).texts("figcaption"))
      if (text.find("direction they face") != std::string::npos) return text;
    return std::string();
  };
  EXPECT_THAT(caption({"--report", path("page.html")}),
              AllOf(HasSubstr("relative to the held tag"), HasSubstr("filled in green"),
                    HasSubstr("Up is as the camera was held")));
  write_text(path("measured.yaml"),
             "apriltrack_constraints: 1\nconstraints:\n"
             "  - {type: gravity, tag: 0, direction: {x: 0.0, y: 0.0, z: 1.0}, sigma_rad: 0.01}\n");
  EXPECT_THAT(caption({"--report", path("page.html"), "--constraints", path("measured.yaml")}),
              AllOf(HasSubstr("relative to the measured frame"), Not(HasSubstr("held one")),
                    HasSubstr("Up is z of the map, as measured")));
  // The wall lies on the floor: from the front its tags are on one line, from above they are not.
  const std::string source = ReadReport(path("page.html")).source();
  EXPECT_GT(height_of_outline(source, "From above"), 10.0);
  EXPECT_LT(height_of_outline(source, "From the front"), 1.0);
  write_text(path("measured.yaml"),
             "apriltrack_constraints: 1\nconstraints:\n"
             "  - {type: position, tag: 0, position_m: {x: 1.0, y: 1.0, z: 1.0}, sigma_m: 0.01}\n");
  EXPECT_THAT(caption({"--report", path("page.html"), "--constraints", path("measured.yaml")}),
              AllOf(HasSubstr("relative to the measured frame"), HasSubstr("Up is as the camera was held")));
}

TEST_F(CalibrateReport, ARefinedCameraReplacesNoInput) {
  film({{40, {0, 1, 2}}});
  const std::string camera = pinhole_entry("cam0", 520.0), own = path("map.camera.yaml");
  write_text(path("camera.yaml"), camera);
  const nlohmann::json first = run_for_json(words({"--intrinsics", "refine"}));
  ASSERT_EQ(first["camera"], own) << "it does refine";

  write_text(own, camera);
  EXPECT_THAT(run_program(words({"--intrinsics", "refine"}, "map.camera.yaml")),
              EndsWith(2, "a refined camera would replace '" + own + "', which this run reads"));
  EXPECT_EQ(read_text(own), camera);
  EXPECT_THAT(run_program(words({"--report", own})), EndsWith(2, "its refined camera"));

  write_text(own, pinhole_entry("cam0"));
  const ProgramRun kept = run_program(words({"--intrinsics", "keep"}, "map.camera.yaml"));
  EXPECT_EQ(kept.status, 0) << kept.err;
  EXPECT_THAT(kept.err, Not(HasSubstr("not of this run"))) << "it is the map's own";
  const ProgramRun other = run_program(words({"--intrinsics", "keep"}));
  EXPECT_EQ(other.status, 0) << other.err;
  EXPECT_THAT(other.err, HasSubstr(own + " is not of this run, which refined no camera: track with " +
                                   path("camera.yaml")));
  EXPECT_EQ(read_text(own), pinhole_entry("cam0")) << "it may be somebody's own";
}

TEST_F(CalibrateReport, NoOutputReplacesAnInputOrAnotherOutput) {
  film({{40, {0, 1, 2}}});
  EXPECT_THAT(run_program(words({"--report", path("map.detections.csv")})), EndsWith(2, "its observations"));
  EXPECT_THAT(run_program(words({"--joint-covariance", path("map.detections.csv")})),
              EndsWith(2, "its observations"));
  const std::string own = path("parts/part_3.yaml");
  write_text(own, pinhole_entry("cam0"));
  EXPECT_THAT(run_program(words({"--parts", path("parts")}, "parts/part_3.yaml")),
              EndsWith(2, "a part would replace '" + own + "'"));
  EXPECT_EQ(read_text(own), pinhole_entry("cam0"));
  EXPECT_FALSE(fs::exists(path("map.yaml")));
}

TEST_F(CalibrateReport, OfNoRowsSaysThatThereAreNone) {
  film({});
  EXPECT_THAT(run_program(words({})), EndsWith(1, "no rows below the header of " + path(kCorners)));
}

TEST_F(CalibrateReport, JointCovarianceHoldsThatOfEachTag) {
  film({{40, {0, 1, 2}}});
  run_for_json(words({"--joint-covariance", path("joint.yaml")}));
  const TagMap map = read_tag_map(path("map.yaml"));
  const YAML::Node joint = YAML::LoadFile(path("joint.yaml"));
  ASSERT_EQ(joint["tags"].size(), map.tags.size());
  ASSERT_EQ(joint["covariance"].size(), 6 * map.tags.size());
  for (std::size_t i = 0; i < map.tags.size(); ++i) {
    EXPECT_EQ(joint["tags"][i]["id"].as<int>(), map.tags[i].key.id);
    for (int row = 0; row < 6; ++row) {
      const YAML::Node numbers = joint["covariance"][6 * i + static_cast<std::size_t>(row)];
      for (int column = 0; column < 6; ++column)
        EXPECT_NEAR(numbers[6 * i + static_cast<std::size_t>(column)].as<double>(),
                    (*map.tags[i].covariance)(row, column), 1e-9 * map.tags[i].covariance->norm());
    }
  }
  const YAML::Node across = joint["covariance"][6][12];
  EXPECT_NE(across.as<double>(), 0.0) << "between two free tags";
  EXPECT_EQ(across.as<double>(), joint["covariance"][12][6].as<double>());
}

}  // namespace
}  // namespace apriltrack::test
