// What was measured beside the images: `calibrate --constraints`.

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "apriltrack/tags/tag_map.h"
#include "filmed_wall.h"
#include "program.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// Tags 0, 1 and 2 of the wall, filmed without an error.
class CalibrateWithConstraints : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string rows = kDetectionsHeader;
    for (int view = 0; view < 20; ++view) {
      for (const int id : {0, 1, 2}) rows += wall_row(50'000'000LL * view, camera_from_wall(view), id);
    }
    write_text(path("d.csv"), rows);
    write_text(path("camera.yaml"), pinhole_entry("cam0"));
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  std::vector<std::string> words(const std::string& constraints) const {
    write_text(path("measured.yaml"), "apriltrack_constraints: 1\nconstraints:\n" + constraints);
    return {"calibrate",          "--detections", path("d.csv"), "--camera",       path("camera.yaml"),
            "--tag-size",         "0.16",         "--output",    path("map.yaml"), "--constraints",
            path("measured.yaml")};
  }
  ProgramRun calibrate(const std::string& constraints) const { return run_program(words(constraints)); }
  bool has_map() const { return std::filesystem::exists(path("map.yaml")); }

 private:
  std::filesystem::path folder_ = temporary_folder();
};

TEST_F(CalibrateWithConstraints, PutsTheMapIntoTheMeasuredFrame) {
  // The wall's own frame, moved by (10, 20, 30).
  const nlohmann::json summary = run_for_json(
      words("  - {type: position, tag: 0, position_m: {x: 10.0, y: 20.0, z: 30.0}, sigma_m: 0.001}\n"
            "  - {type: position, tag: 1, position_m: {x: 10.4, y: 20.0, z: 30.0}, sigma_m: 0.001}\n"
            "  - {type: position, tag: 2, position_m: {x: 10.0, y: 20.3, z: 30.0}, sigma_m: 0.001}\n"
            "  - {type: distance, name: edge, tags: [1, 2], distance_m: 0.5, sigma_m: 0.001}\n"));
  EXPECT_EQ(summary["gauge"], "measured: position 0, position 1, position 2");
  ASSERT_EQ(summary["constraints"].size(), 4u);
  const nlohmann::json& edge = summary["constraints"][3];
  EXPECT_EQ(edge["name"], "edge");
  EXPECT_EQ(edge["type"], "distance");
  EXPECT_EQ(edge["tags"], (nlohmann::json{"tag36h11/1", "tag36h11/2"}));
  EXPECT_EQ(edge["used"], true);
  EXPECT_LT(edge["z"].get<double>(), 0.1);
  ASSERT_EQ(edge["readings"].size(), 1u);
  EXPECT_EQ(edge["readings"][0]["measured"], 0.5);
  EXPECT_NEAR(edge["readings"][0]["predicted"].get<double>(), 0.5, 1e-4);
  EXPECT_GT(edge["readings"][0]["sigma"].get<double>(), 0.001);
  const TagMap map = read_tag_map(path("map.yaml"));
  for (const MapTag& tag : map.tags) {
    const Eigen::Vector3d truth = kWallPlaces_m.at(tag.key.id) + Eigen::Vector3d(10.0, 20.0, 30.0);
    EXPECT_LT((tag.T_map_tag.translation() - truth).norm(), 1e-4);
  }
  EXPECT_THAT(read_text(path("map.yaml")), HasSubstr("measured: position 0, position 1, position 2"));
}

TEST_F(CalibrateWithConstraints, TellsEachOfThemAgainstAllElse) {
  const ProgramRun run = calibrate(
      "  - {type: distance, tags: [1, 2], distance_m: 0.501, sigma_m: 0.001}\n"
      "  - {type: upright, tags: [0], sigma_rad: 0.01}\n");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("distance 1-2  distance +1.00 mm (sigma 1."),
                             HasSubstr("upright 0     nothing else tells"),
                             HasSubstr("kept as with tag36h11/0 held at the origin: heading, x, y, z")));
}

TEST_F(CalibrateWithConstraints, ShowsThemOnThePage) {
  std::vector<std::string> with_page =
      words("  - {type: distance, name: wall <a>, tags: [1, 2], distance_m: 0.501, sigma_m: 0.001}\n");
  with_page.insert(with_page.end(), {"--report", path("page.html")});
  ASSERT_EQ(run_program(with_page).status, 0);
  EXPECT_THAT(read_text(path("page.html")),
              AllOf(HasSubstr("What was measured beside the images"), HasSubstr("wall &lt;a&gt;"),
                    HasSubstr("501 mm"), Not(HasSubstr("wall <a>"))));
}

TEST_F(CalibrateWithConstraints, WritesNoMapWhereOneContradictsTheRest) {
  const ProgramRun run = calibrate(
      "  - {type: distance, tags: [0, 1], distance_m: 0.4, sigma_m: 0.001}\n"
      "  - {type: distance, tags: [1, 2], distance_m: 0.6, sigma_m: 0.001}\n");
  EXPECT_THAT(
      run, EndsWith(1, "measured.yaml:4: distance 1-2: distance: 0.6000 m measured, all else says 0.5000 m"));
  EXPECT_THAT(run.err, Not(HasSubstr("distance 0-1: distance")));
  EXPECT_FALSE(has_map());
}

TEST_F(CalibrateWithConstraints, TellsMachinesWhyThereIsNoMap) {
  std::vector<std::string> contradictory = words(
      "  - {type: distance, tags: [0, 1], distance_m: 0.4, sigma_m: 0.001}\n"
      "  - {type: distance, name: tape, tags: [1, 2], distance_m: 0.6, sigma_m: 0.001}\n");
  contradictory.emplace_back("--json");
  const ProgramRun run = run_program(contradictory);
  ASSERT_EQ(run.status, 1);
  const nlohmann::json error = nlohmann::json::parse(run.out).at("error");
  EXPECT_EQ(error["kind"], "no_result");
  EXPECT_EQ(error["status"], 1);
  EXPECT_THAT(run.err, HasSubstr("error: " + error["message"].get<std::string>()));
  ASSERT_EQ(error["constraints"].size(), 2u);
  EXPECT_EQ(error["constraints"][0]["used"], true);
  EXPECT_EQ(error["constraints"][1]["name"], "tape");
  EXPECT_EQ(error["constraints"][1]["used"], false);
  EXPECT_GT(error["constraints"][1]["z"].get<double>(), 5.0);
  EXPECT_NEAR(error["constraints"][1]["readings"][0]["predicted"].get<double>(), 0.5, 1e-3);
  EXPECT_THAT(run.err, HasSubstr("tape"));
  EXPECT_THAT(run.err, HasSubstr("not used: contradicts all else: distance +100"));
}

TEST_F(CalibrateWithConstraints, RefusesWhatItCannotRead) {
  EXPECT_THAT(calibrate("  - {type: distance, tags: [0, 99], distance_m: 0.4, sigma_m: 0.001}\n"),
              EndsWith(2, "measured.yaml:3: distance 0-99: tag 99 was never seen; seen were: tag36h11/0"));
  EXPECT_THAT(calibrate("  - {type: distance, tags: [0, 1], distance_m: 0.4, sigma: 0.001}\n"),
              EndsWith(2, "measured.yaml:3"));
  std::vector<std::string> missing = words("");
  missing.back() = path("nowhere.yaml");
  EXPECT_THAT(run_program(missing), EndsWith(3, "nowhere.yaml"));
  std::vector<std::string> onto_itself = words("  - {type: upright, tags: [0], sigma_rad: 0.01}\n");
  onto_itself[8] = path("measured.yaml");
  EXPECT_THAT(run_program(onto_itself), EndsWith(2, "is an input"));
  EXPECT_FALSE(has_map());
}

}  // namespace
}  // namespace apriltrack::test
