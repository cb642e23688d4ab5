// `track --report` of detections: stretches without evidence, the map's part in the claims, long recordings.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

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
using testing::Not;

/// Corners of the wall's tags 0 to 2, in place of images.
class TrackReportOfCorners : public ::testing::Test {
 protected:
  /// tags_of: the tags that are seen in a frame; number 10 is not in the map.
  ReadReport track(int num_frames, std::int64_t interval_ns,
                   const std::function<std::vector<int>(int)>& tags_of, const std::string& of_each_tag = "") {
    {
      std::ofstream rows(folder_ / "corners.csv");
      rows << kDetectionsHeader;
      for (int i = 0; i < num_frames; ++i)
        for (const int id : tags_of(i))
          rows << wall_row(1'000'000'000LL + interval_ns * i, camera_from_wall(i % 7), id);
    }
    write_text(folder_ / "camera.yaml", pinhole_entry("cam0"));
    std::string map = "apriltrack_map: 1\nframe: wall\ndefault_family: tag36h11\ntags:\n";
    for (const int id : {0, 1, 2})
      map += fmt::format(
          "  - id: {}\n    size: 0.16\n    pose:\n      position: {{x: {}, y: {}, z: {}}}\n      "
          "orientation: {{x: 0.0, y: 0.0, z: 0.0, w: 1.0}}\n{}",
          id, kWallPlaces_m.at(id).x(), kWallPlaces_m.at(id).y(), kWallPlaces_m.at(id).z(), of_each_tag);
    write_text(folder_ / "map.yaml", map);
    run_for_json({"track", "--detections", folder_ / "corners.csv", "--camera", folder_ / "camera.yaml",
                  "--map", folder_ / "map.yaml", "--output", folder_ / "out.tum", "--report",
                  folder_ / "report.html"});
    return ReadReport(folder_ / "report.html");
  }

  const fs::path folder_ = temporary_folder();
};

TEST_F(TrackReportOfCorners, TellsWhereTheEvidenceIsMissing) {
  // Nothing of the map in frames 0, 3 to 7, and 18 and 19, ten a second.
  const ReadReport page = track(20, 100'000'000, [](int i) {
    const bool is_blind = i == 0 || (i >= 3 && i <= 7) || i >= 18;
    return is_blind ? std::vector<int>{10} : std::vector<int>{0, 1, 2};
  });
  EXPECT_THAT(page.row("longest stretch without evidence"),
              ElementsAre("0.600 s (5 frames), from 0.200 s to 0.800 s"));
  EXPECT_THAT(page.row("first pose"), ElementsAre("at 0.100 s"));
  const std::string reason = "no tag of the map seen";
  EXPECT_THAT(page.row("0.200"), ElementsAre("0.600", "5 lost", "1300000000", reason));
  EXPECT_THAT(page.row("1.700"), ElementsAre("0.200", "2 lost", "2800000000", reason));
  EXPECT_THAT(page.row("0.000"), ElementsAre("0.100", "1 lost", "1000000000", reason));
  EXPECT_THAT(page.row(reason), ElementsAre("8"));
  EXPECT_THAT(page.texts("p"), Contains(HasSubstr("not in the map, and so of no use: tag36h11/10.")));
}

/// A tag's covariance: sigma_m along each axis, and next to nothing for its orientation.
std::string covariance_entry(double sigma_m) {
  std::string text = "    covariance: [";
  for (int i = 0; i < 36; ++i) {
    const double number = i % 7 != 0 ? 0.0 : i < 18 ? sigma_m * sigma_m : 1e-12;
    text += fmt::format("{}{}", i == 0 ? "" : ", ", number);
  }
  return text + "]\n";
}

TEST_F(TrackReportOfCorners, TellsOfTheMapsPartInTheClaimedError) {
  const std::string words = "The map's own uncertainty";
  const auto all_tags = [](int) { return std::vector<int>{0, 1, 2}; };
  const ReadReport vague = track(6, 100'000'000, all_tags, covariance_entry(0.01));
  EXPECT_THAT(vague.texts("p"), Contains(AllOf(HasSubstr(words), HasSubstr("17.32 mm"))));  // 10 mm x root 3
  EXPECT_GT(numbers_in(vague.row("claimed error (sigma), median of all poses")[0])[0], 5.0);
  const ReadReport sure = track(6, 100'000'000, all_tags, covariance_entry(1e-7));
  EXPECT_THAT(sure.texts("p"), Not(Contains(HasSubstr(words))));
  const ReadReport untold = track(6, 100'000'000, all_tags);
  EXPECT_THAT(untold.texts("p"), Not(Contains(HasSubstr(words))));
}

TEST_F(TrackReportOfCorners, OfTenThousandFramesIsNoLargerThanItsPictures) {
  const ReadReport page = track(10'000, 33'333'333, [](int i) {
    return i % 3 == 0 ? std::vector<int>{0} : std::vector<int>{0, 1, 2};
  });
  EXPECT_THAT(page.row("detected")[0], "10000");
  EXPECT_THAT(page.row("input")[0], HasSubstr("corners.csv"));
  EXPECT_LT(fs::file_size(folder_ / "report.html"), 4'000'000U);
}

}  // namespace
}  // namespace apriltrack::test
