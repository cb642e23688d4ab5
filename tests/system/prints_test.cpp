// Tags of two prints that were given one size: calibrate says which, to people and to machines.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "filmed_wall.h"
#include "program.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(Prints, OfTwoSizesAreTold) {
  const fs::path folder = temporary_folder();
  const auto path = [&](const std::string& name) { return (folder / name).string(); };
  std::string csv = kDetectionsHeader;
  for (int view = 0; view < 40; ++view) {
    for (const int id : {0, 1, 2, 10, 11}) csv += wall_row(100'000'000LL * view, camera_from_wall(view), id);
  }
  write_text(path("corners.csv"), csv);
  write_text(path("camera.yaml"), pinhole_entry("cam0"));
  write_text(path("sizes.yaml"), "default: 0.16\nsizes:\n  2: 0.157\n  10: 0.157\n  11: 0.157\n");

  const ProgramRun run =
      run_program({"calibrate", "--detections", path("corners.csv"), "--camera", path("camera.yaml"),
                   "--tag-sizes", path("sizes.yaml"), "--json", "--output", path("map.yaml")});

  ASSERT_EQ(run.status, 0) << run.err;
  const auto summary = nlohmann::json::parse(run.out);
  ASSERT_TRUE(summary.contains("print_batches")) << run.out;
  const auto& prints = summary["print_batches"];
  EXPECT_EQ(prints["larger"], nlohmann::json({"tag36h11/2", "tag36h11/10", "tag36h11/11"}));
  EXPECT_EQ(prints["smaller"], nlohmann::json({"tag36h11/0", "tag36h11/1"}));
  EXPECT_NEAR(prints["log_ratio"].get<double>(), 0.0189, 0.002);  // ln(0.160 / 0.157)
  EXPECT_THAT(run.err,
              AllOf(HasSubstr("two prints of different size: tag36h11/2, tag36h11/10, tag36h11/11 are 1.9 %"),
                    HasSubstr("--tag-sizes")));
  const auto& findings = summary["findings"];  // the keys of docs/file_formats.md
  const auto found =
      std::ranges::find_if(findings, [](const auto& one) { return one["kind"] == "size_groups"; });
  ASSERT_NE(found, findings.end()) << findings;
  EXPECT_EQ((*found)["tags"], prints["larger"]);
  EXPECT_EQ((*found)["alternatives"], nlohmann::json::array({prints["smaller"]}));
  EXPECT_NEAR((*found)["value"].get<double>(), 0.160 / 0.157, 0.002);
  EXPECT_EQ((*found)["unit"], "1");
  EXPECT_GT((*found)["sigma"].get<double>(), 0.0);
  EXPECT_TRUE((*found)["time_ns"].is_null());
  EXPECT_TRUE((*found)["log_odds"].is_null());
  EXPECT_EQ((*found)["left_out"], false);
  EXPECT_THAT(run.err, HasSubstr((*found)["message"].get<std::string>()));
}

}  // namespace
}  // namespace apriltrack::test
