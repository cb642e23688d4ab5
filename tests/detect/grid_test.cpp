#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "apriltrack/detect/detector.h"
#include "apriltrack/tags/aprilgrid.h"
#include "apriltrack/tags/tag_family.h"
#include "corner_statistics.h"
#include "plane_renderer.h"

namespace apriltrack {
namespace {

using test::CornerStatistics;
using test::PlaneView;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr int kMinTags = 34;  // of 36, on any one image

struct Grid {
  AprilGrid layout;
  TagMap map = layout.map();
  AprilGridPicture picture{layout};
  Eigen::Vector2d middle = layout.printed_area_m().center();

  GrayImage render(const PlaneView& view, std::uint64_t seed) const {
    test::RenderOptions options;
    options.samples = 3;
    options.seed = seed;
    const auto brightness = [&](double x, double y) {
      return picture.brightness(x + middle.x(), y + middle.y());
    };
    return test::render_plane(752, 480, view, brightness, options);
  }

  std::array<Eigen::Vector2d, kNumCorners> corners_px(const PlaneView& view, const MapTag& tag) const {
    std::array<Eigen::Vector2d, kNumCorners> corners;
    const auto in_map = corners_in_map(tag);
    for (std::size_t k = 0; k < kNumCorners; ++k) corners[k] = view.to_pixel(in_map[k].head<2>() - middle);
    return corners;
  }
};

bool is_inside(const std::array<Eigen::Vector2d, kNumCorners>& corners_px) {
  return std::ranges::all_of(corners_px, [](const Eigen::Vector2d& corner) {
    return corner.x() > 2.0 && corner.y() > 2.0 && corner.x() < 749.0 && corner.y() < 477.0;
  });
}

TEST(DetectKalibrGrid, FindsNearlyAllTagsAtTheirPlaces) {
  const Grid grid;
  Detector detector({.families = {"tag36h11b2"}});
  CornerStatistics statistics;
  int images = 0;
  for (const double tilt_deg : {20.0, 30.0, 40.0, 50.0, 60.0}) {
    for (const double axis_deg : {10.0, 100.0}) {
      const PlaneView view(460.0, {372.3, 241.4}, 0.95, tilt_deg * kDegree, axis_deg * kDegree,
                           7.0 * kDegree);
      const auto detections = detector.detect(grid.render(view, static_cast<std::uint64_t>(++images)).view());
      for (const MapTag& tag : grid.map.tags)
        ASSERT_TRUE(is_inside(grid.corners_px(view, tag))) << tag.key.id;
      std::set<int> ids;
      for (const Detection& detection : detections) {
        const MapTag* tag = grid.map.find(detection.tag);
        ASSERT_NE(tag, nullptr) << "false id " << detection.tag.id;
        EXPECT_TRUE(ids.insert(detection.tag.id).second) << "tag " << detection.tag.id << " twice";
        statistics.add(detection.corners_px, grid.corners_px(view, *tag));
      }
      EXPECT_GE(static_cast<int>(ids.size()), kMinTags)
          << "tilt " << tilt_deg << " about " << axis_deg << " deg";
    }
  }
  EXPECT_EQ(images, 10);
  EXPECT_LE(std::abs(statistics.radial_bias_px()), test::kMaxBias_px);
  EXPECT_LE(statistics.rms_per_axis_px(), test::kMaxRms_px);
  EXPECT_LE(statistics.largest_px(), 1.0) << "no tag is somewhere else";
}

/// Linear pictures that are taken for sRGB grow black, and join the tags' borders all the more: what is read
/// must not hang on what is assumed. (A wrong response costs some their corners.)
TEST(DetectKalibrGrid, FindsNearlyAllTagsWhicheverResponseIsAssumed) {
  const Grid grid;
  const PlaneView view(320.0, {372.3, 241.4}, 0.95, 40.0 * kDegree, 10.0 * kDegree, 7.0 * kDegree);
  for (const bool is_srgb : {false, true}) {
    test::RenderOptions options;
    options.samples = 3;
    options.is_srgb = is_srgb;
    const GrayImage image = test::render_plane(
        752, 480, view,
        [&](double x, double y) { return grid.picture.brightness(x + grid.middle.x(), y + grid.middle.y()); },
        options);
    for (const ResponseCurve& assumed : {ResponseCurve::srgb(), ResponseCurve::linear()}) {
      Detector detector({.families = {"tag36h11b2"}, .response = assumed});
      const FoundTags found = detector.find(image.view());
      std::set<int> ids;
      for (const Detection& detection : found.detections) ids.insert(detection.tag.id);
      for (const LeftOutTag& tag : found.left_out) ids.insert(tag.reading.tag.id);
      EXPECT_GE(static_cast<int>(ids.size()), kMinTags)
          << (is_srgb ? "sRGB" : "linear") << " taken for " << assumed.name();
    }
  }
}

TEST(DetectKalibrGrid, ReportsASquareOnceWhenBothBordersAreSoughtFor) {
  const Grid grid;
  const PlaneView view(460.0, {372.3, 241.4}, 0.95, 25.0 * kDegree, 40.0 * kDegree, 0.0);
  Detector detector({.families = {"tag36h11", "tag36h11b2"}});
  const auto detections = detector.detect(grid.render(view, 3).view());
  ASSERT_GE(static_cast<int>(detections.size()), kMinTags);
  for (std::size_t a = 0; a < detections.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      const Eigen::Vector2d apart = detections[a].corners_px[0] - detections[b].corners_px[0];
      const Eigen::Vector2d opposite = detections[a].corners_px[0] - detections[b].corners_px[2];
      EXPECT_GT(std::min(apart.norm(), opposite.norm()), 5.0);
    }
  }
}

/// Tags of `family` on white paper, in a row.
GrayImage print_and_see(const char* family, const std::vector<int>& ids, double width_px, double turn_rad,
                        const Eigen::Vector2d& motion_px) {
  std::vector<TagPattern> patterns;
  for (const int id : ids) patterns.push_back(TagFamily::get(family).pattern(id));
  constexpr double size_m = 0.1;
  constexpr double kStep_m = 0.15;
  const PlaneView view(600.0, {319.3, 60.6}, 600.0 * size_m / width_px, 10.0 * kDegree, 0.3, turn_rad);
  test::RenderOptions options;
  options.samples = 2;
  const double first_m = -0.5 * kStep_m * static_cast<double>(ids.size() - 1);
  const auto paper = [&](double x, double y) {
    const double place = std::round((x - first_m) / kStep_m);
    if (place < 0.0 || place >= static_cast<double>(ids.size())) return 1.0;
    const double tag_x = x - first_m - place * kStep_m;
    return patterns[static_cast<std::size_t>(place)].brightness(2.0 * tag_x / size_m, 2.0 * y / size_m);
  };
  const auto brightness = [&](double x, double y) {  // three instants of an exposure
    const Eigen::Vector2d step_m = motion_px * size_m / width_px / 3.0;
    return (paper(x, y) + paper(x + step_m.x(), y + step_m.y()) + paper(x - step_m.x(), y - step_m.y())) /
           3.0;
  };
  return test::render_plane(640, 120, view, brightness, options);
}

// The codes of both families are the same, and the library reads most of the one as the other.
TEST(DetectTwoCellBorder, IsToldFromOneCellForEveryId) {
  Detector grid_detector({.families = {"tag36h11b2"}});
  const int num_codes = TagFamily::get("tag36h11").num_codes();
  constexpr int kInARow = 7;
  int seen_on_grid = 0;
  int image = 0;
  for (int first = 0; first < num_codes; first += kInARow, ++image) {
    std::vector<int> ids;
    for (int id = first; id < std::min(first + kInARow, num_codes); ++id) ids.push_back(id);
    const Eigen::Vector2d motion_px = image % 2 ? Eigen::Vector2d(4.0, 2.0) : Eigen::Vector2d(0.0, 0.0);
    const double turn_rad = 0.02 * (image % 3);
    const GrayImage plain = print_and_see("tag36h11", ids, 50.0, turn_rad, motion_px);
    for (const Detection& wrong : grid_detector.detect(plain.view()))
      ADD_FAILURE() << to_string(wrong.tag) << " in image " << image;
    const GrayImage grid = print_and_see("tag36h11b2", ids, 50.0, turn_rad, motion_px);
    seen_on_grid += static_cast<int>(grid_detector.detect(grid.view()).size());
  }
  EXPECT_GE(seen_on_grid, num_codes * 95 / 100);
}

TEST(DetectTwoCellBorder, LosesToOneCellWhereBothAreSoughtFor) {
  Detector both({.families = {"tag36h11b2", "tag36h11"}});
  const auto seen = both.detect(print_and_see("tag36h11", {3, 107, 215, 400}, 70.0, 0.1, {0.0, 0.0}).view());
  ASSERT_EQ(seen.size(), 4U);
  for (const Detection& detection : seen) EXPECT_EQ(detection.tag.family, "tag36h11");
}

}  // namespace
}  // namespace apriltrack
