#include <gtest/gtest.h>

#include <numbers>

#include "apriltrack/detect/detector.h"
#include "apriltrack/tags/tag_family.h"
#include "corner_statistics.h"
#include "plane_renderer.h"

namespace apriltrack {
namespace {

using std::numbers::pi;
using test::CornerStatistics;
using test::PlaneView;

constexpr double kFamilyTagSize_m = 0.1;

struct Seen {
  GrayImage image;
  std::array<Eigen::Vector2d, kNumCorners> corners_px;
};

Seen see(const TagPattern& pattern, int view_number) {
  // The detected square of the standard families is 5/9 of what is printed: same cells, more room.
  const double width_px = 9.0 * pattern.width_at_border() + 7.0 * view_number;
  const PlaneView view(600.0, {119.3, 120.6}, 600.0 * kFamilyTagSize_m / width_px,
                       (15.0 + 12.0 * view_number) * pi / 180.0, 0.9 * view_number + 0.2,
                       1.3 * view_number + 0.3);
  test::RenderOptions options;
  options.samples = 3;
  options.seed = static_cast<std::uint64_t>(view_number + 1);
  const auto brightness = [&](double x, double y) {
    return pattern.brightness(2.0 * x / kFamilyTagSize_m, 2.0 * y / kFamilyTagSize_m);
  };
  Seen seen;
  seen.image = test::render_plane(240, 240, view, brightness, options);
  const auto in_tag = tag_corners(kFamilyTagSize_m);
  for (std::size_t k = 0; k < kNumCorners; ++k) seen.corners_px[k] = view.to_pixel(in_tag[k].head<2>());
  return seen;
}

class DetectFamily : public ::testing::TestWithParam<std::string_view> {};

TEST_P(DetectFamily, ReadsIdsAndPlacesCornersInOrder) {
  const TagFamily& family = TagFamily::get(GetParam());
  Detector detector({.families = {family.name()}});
  CornerStatistics statistics;
  const int num_views = 4;
  for (int i = 0; i < num_views; ++i) {
    const int id = i * (family.num_codes() - 1) / (num_views - 1);
    const Seen seen = see(family.pattern(id), i);
    const auto detections = detector.detect(seen.image.view());
    ASSERT_EQ(detections.size(), 1U) << "id " << id;
    EXPECT_EQ(detections[0].tag, (TagKey{family.name(), id}));
    EXPECT_EQ(detections[0].hamming, 0);
    statistics.add(detections[0].corners_px, seen.corners_px);
  }
  ASSERT_EQ(statistics.num_tags(), num_views);
  EXPECT_LE(std::abs(statistics.radial_bias_px()), 0.04);
  EXPECT_LE(statistics.rms_per_axis_px(), 0.1);
  EXPECT_LE(statistics.largest_px(), 0.4) << "a turned corner order would be a whole edge off";
}

INSTANTIATE_TEST_SUITE_P(AllFamilies, DetectFamily,
                         ::testing::ValuesIn(TagFamily::names().begin(), TagFamily::names().end()),
                         [](const auto& family) { return std::string(family.param); });

TEST(DetectFamilies, SeveralAtOnceAreReportedByFamilyThenId) {
  GrayImage image(720, 240, 255);
  const std::vector<TagKey> keys = {{"tagStandard41h12", 3}, {"tag25h9", 7}, {"tag36h11", 11}};
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const Seen seen = see(TagFamily::get(keys[i].family).pattern(keys[i].id), 1);
    for (int y = 0; y < 240; ++y)
      std::copy_n(seen.image.row(y), 240, image.row(y) + 240 * static_cast<std::ptrdiff_t>(i));
  }
  Detector detector({.families = {"tag36h11", "tagStandard41h12", "tag25h9"}});
  const auto detections = detector.detect(image.view());
  ASSERT_EQ(detections.size(), 3U);
  EXPECT_EQ(detections[0].tag, keys[1]);
  EXPECT_EQ(detections[1].tag, keys[2]);
  EXPECT_EQ(detections[2].tag, keys[0]);
}

TEST(DetectFamilies, AnOrdinaryTagIsNotTakenForOneWithATwoCellBorder) {
  // The wide family reads ordinary tags too, with the right id but a wrong size.
  Detector detector({.families = {"tag36h11", "tag36h11b2"}});
  int read = 0;
  for (int i = 0; i < 4; ++i) {
    const auto detections = detector.detect(see(TagFamily::get("tag36h11").pattern(40 + i), i).image.view());
    for (const Detection& detection : detections) EXPECT_EQ(detection.tag, (TagKey{"tag36h11", 40 + i}));
    read += static_cast<int>(detections.size());
  }
  EXPECT_EQ(read, 4);
}

}  // namespace
}  // namespace apriltrack
