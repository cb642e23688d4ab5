#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <string>
#include <vector>

#include "apriltrack/base/check.h"
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

/// Tags of three families side by side, each in its third of the image.
class SeveralFamilies : public ::testing::Test {
 protected:
  SeveralFamilies() {
    for (std::size_t i = 0; i < keys_.size(); ++i) {
      const Seen seen = see(TagFamily::get(keys_[i].family).pattern(keys_[i].id), 1);
      for (int y = 0; y < kSide_px; ++y)
        std::copy_n(seen.image.row(y), kSide_px, image_.row(y) + kSide_px * static_cast<std::ptrdiff_t>(i));
    }
  }
  static ImageRegion third(int i) { return {kSide_px * i, 0, kSide_px, kSide_px}; }

  static constexpr int kSide_px = 240;
  const std::vector<TagKey> keys_ = {{"tagStandard41h12", 3}, {"tag25h9", 7}, {"tag36h11", 11}};
  GrayImage image_{3 * kSide_px, kSide_px, 255};
  Detector detector_{{.families = {"tag36h11", "tagStandard41h12", "tag25h9"}}};
};

TEST_F(SeveralFamilies, AtOnceAreReportedByFamilyThenId) {
  const auto detections = detector_.detect(image_.view());
  ASSERT_EQ(detections.size(), 3U);
  EXPECT_EQ(detections[0].tag, keys_[1]);
  EXPECT_EQ(detections[1].tag, keys_[2]);
  EXPECT_EQ(detections[2].tag, keys_[0]);
}

TEST_F(SeveralFamilies, AreFoundInRegionsWhereTheyAreInTheWholeImage) {
  const auto everywhere = detector_.detect(image_.view());
  for (const Detection& expected : everywhere) {
    const auto place = std::ranges::find(keys_, expected.tag) - keys_.begin();
    const TagRegion any{third(static_cast<int>(place)), {}},
        own{third(static_cast<int>(place)), expected.tag.family};
    for (const TagRegion& region : {any, own}) {
      const auto found = detector_.detect_in(image_.view(), std::array{region});
      ASSERT_EQ(found.size(), 1U) << expected.tag.family;
      EXPECT_EQ(found[0].tag, expected.tag);
      for (std::size_t i = 0; i < kNumCorners; ++i)
        EXPECT_LT((found[0].corners_px[i] - expected.corners_px[i]).norm(), 0.02);
    }
  }
}

TEST_F(SeveralFamilies, AreNotLookedForInRegionsOfOthers) {
  const auto found_for = [&](const std::string& family) {
    std::vector<TagRegion> regions;
    for (int i = 0; i < 3; ++i) regions.push_back({third(i), family});
    return detector_.detect_in(image_.view(), regions);
  };
  for (const TagKey& key : keys_) {
    const auto found = found_for(key.family);
    ASSERT_EQ(found.size(), 1U) << key.family;
    EXPECT_EQ(found[0].tag, key);
  }
  EXPECT_THROW(found_for("tag16h5"), MisuseError) << "the detector's options do not name it";
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
