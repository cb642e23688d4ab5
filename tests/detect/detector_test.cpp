#include "apriltrack/detect/detector.h"

#include <gmock/gmock.h>

#include <array>
#include <limits>

#include "apriltrack/base/error.h"
#include "apriltrack/base/random.h"
#include "apriltrack/tags/tag_family.h"
#include "plane_renderer.h"

namespace apriltrack {
namespace {

using test::PlaneView;
using ::testing::HasSubstr;

constexpr double kTagSize_m = 0.1;

/// Nine tags in three rows; the ids repeat.
GrayImage render_nine(double noise_light) {
  const TagFamily& family = TagFamily::get("tag36h11");
  const std::vector<TagPattern> patterns = {family.pattern(5), family.pattern(2), family.pattern(5)};
  const PlaneView view(500.0, {199.6, 149.7}, 1.1, 0.3, 0.8, 0.1);
  test::RenderOptions options;
  options.samples = 3;
  options.noise_light = noise_light;
  const auto brightness = [&](double x, double y) {
    const double pitch_m = 1.5 * kTagSize_m;
    const int column = static_cast<int>(std::floor(x / pitch_m + 1.5));
    const int row = static_cast<int>(std::floor(y / pitch_m + 1.5));
    if (column < 0 || column > 2 || row < 0 || row > 2) return 1.0;
    const double u = 2.0 * (x - (column - 1) * pitch_m) / kTagSize_m;
    const double v = 2.0 * (y - (row - 1) * pitch_m) / kTagSize_m;
    return patterns[static_cast<std::size_t>(column)].brightness(u, v);
  };
  return test::render_plane(400, 300, view, brightness, options);
}

bool are_equal(const std::vector<Detection>& a, const std::vector<Detection>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Detection& x, const Detection& y) {
    return x.tag == y.tag && x.corners_px == y.corners_px && x.hamming == y.hamming &&
           x.decision_margin == y.decision_margin;
  });
}

TEST(Detector, ReportsEveryCopyOfAnIdInTheOrderOfPlaces) {
  Detector detector({});
  const auto detections = detector.detect(render_nine(0.002).view());
  ASSERT_EQ(detections.size(), 9U);
  for (std::size_t i = 0; i < 9; ++i) EXPECT_EQ(detections[i].tag.id, i < 3 ? 2 : 5);
  const auto centre_x = [&](std::size_t i) {
    return detections[i].corners_px[0].x() + detections[i].corners_px[2].x();
  };
  for (std::size_t i = 4; i < 9; ++i) EXPECT_LT(centre_x(i - 1), centre_x(i));
}

TEST(Detector, GivesTheSameAnswerEveryTime) {
  const GrayImage image = render_nine(0.01);
  Detector one({});
  Detector two({});
  const auto first = one.detect(image.view());
  ASSERT_EQ(first.size(), 9U);
  EXPECT_TRUE(are_equal(first, one.detect(image.view()))) << "the same detector again";
  EXPECT_TRUE(are_equal(first, two.detect(image.view()))) << "another detector";
  Detector moved = std::move(one);
  EXPECT_TRUE(are_equal(first, moved.detect(image.view()))) << "moved elsewhere";
}

TEST(Detector, ReadsAViewWithPaddingBetweenRows) {
  const GrayImage image = render_nine(0.002);
  GrayImage padded(image.width() + 37, image.height(), 99);
  for (int y = 0; y < image.height(); ++y) std::copy_n(image.row(y), image.width(), padded.row(y));
  Detector detector({});
  EXPECT_TRUE(are_equal(detector.detect(image.view()),
                        detector.detect({padded.row(0), image.width(), image.height(), padded.width()})));
}

TEST(Detector, DropsWhatIsBelowTheMarginLimit) {
  const GrayImage image = render_nine(0.002);
  Detector all({});
  const auto detections = all.detect(image.view());
  ASSERT_EQ(detections.size(), 9U);
  double largest = 0.0;
  for (const Detection& detection : detections) largest = std::max(largest, *detection.decision_margin);
  Detector none({.min_decision_margin = std::min(255.0, largest + 1.0)});
  EXPECT_TRUE(none.detect(image.view()).empty());
}

TEST(Detector, CorrectsNoMoreBitsThanAllowed) {
  // Two data cells of the printed tag turned round: two wrong bits.
  const TagPattern good = TagFamily::get("tag36h11").pattern(17);
  Image<float> cells = good.cells();
  cells(3, 3) = 1.0F - cells(3, 3);
  cells(6, 5) = 1.0F - cells(6, 5);
  const TagPattern bad(std::move(cells), good.width_at_border());
  const PlaneView view(500.0, {99.6, 99.3}, 0.6, 0.2, 0.8, 0.1);
  const GrayImage image = test::render_plane(
      200, 200, view,
      [&](double x, double y) { return bad.brightness(2.0 * x / kTagSize_m, 2.0 * y / kTagSize_m); }, {});
  for (const int max_hamming : {0, 1, 2}) {
    Detector detector({.max_hamming = max_hamming});
    const auto detections = detector.detect(image.view());
    ASSERT_EQ(detections.size(), max_hamming == 2 ? 1U : 0U) << max_hamming;
    if (max_hamming == 2) {
      EXPECT_EQ(detections[0].tag.id, 17);
      EXPECT_EQ(detections[0].hamming, 2);
    }
  }
}

TEST(Detector, SeesNoTagsInNoiseAndClutter) {
  Detector detector({});
  RandomStream random(20);
  int images = 0;
  for (const int cell_px : {1, 3, 6, 11}) {
    GrayImage image(640, 480);
    Image<std::uint8_t> cells(640 / cell_px + 1, 480 / cell_px + 1);
    for (int y = 0; y < cells.height(); ++y)
      for (int x = 0; x < cells.width(); ++x)
        cells(x, y) = static_cast<std::uint8_t>(random.uniform(0.0, 256.0));
    for (int y = 0; y < 480; ++y)
      for (int x = 0; x < 640; ++x) image(x, y) = cells(x / cell_px, y / cell_px);
    EXPECT_TRUE(detector.detect(image.view()).empty()) << "cells of " << cell_px << " px";
    ++images;
  }
  EXPECT_EQ(images, 4);
}

TEST(Detector, TakesImagesOfAnySize) {
  Detector detector({.families = {"tag36h11", "tag36h11b2"}});
  for (const int side : {0, 1, 2, 3, 5, 8, 11, 12, 13, 17, 31}) {
    const GrayImage image(side, side, 200);
    EXPECT_TRUE(detector.detect(image.view()).empty()) << side;
  }
}

TEST(Detector, PlacesATagThatTheImageCuts) {
  const TagPattern pattern = TagFamily::get("tag36h11").pattern(8);
  // The left border's outer part lies outside: the library takes the image's end for the tag's edge.
  const PlaneView view(500.0, {40.0, 60.0}, 0.6, 0.0, 0.0, 0.02);
  const GrayImage image = test::render_plane(
      120, 120, view,
      [&](double x, double y) { return pattern.brightness(2.0 * x / kTagSize_m, 2.0 * y / kTagSize_m); }, {});
  const FoundTags found = Detector({}).find(image.view());
  ASSERT_EQ(found.detections.size(), 1U);
  EXPECT_EQ(found.detections[0].tag, (TagKey{"tag36h11", 8}));
  const auto corners = tag_corners(kTagSize_m);
  for (std::size_t k = 0; k < kNumCorners; ++k)
    EXPECT_LT((found.detections[0].corners_px[k] - view.to_pixel(corners[k].head<2>())).norm(), 0.2) << k;
}

TEST(Detector, LeavesOutWhatShowsNoLight) {
  // The library reads tags in grey levels, but by this response they all stand for the same light.
  std::array<float, 256> even;
  even.fill(0.5F);
  DetectorOptions options;
  options.response = ResponseCurve(even);
  const FoundTags found = Detector(options).find(render_nine(0.002).view());
  EXPECT_TRUE(found.detections.empty());
  ASSERT_EQ(found.left_out.size(), 9U) << "but it says so";
  for (const auto& left_out : found.left_out) EXPECT_EQ(left_out.reason, LeftOutReason::kEdgesNotFitted);
}

TEST(Detector, LeavesNothingOutOfAGoodPicture) {
  const FoundTags found = Detector({}).find(render_nine(0.002).view());
  EXPECT_EQ(found.detections.size(), 9U);
  EXPECT_TRUE(found.left_out.empty());
}

TEST(Detector, FindsTagsBesideBrightLightWhateverTheResponse) {
  // Beyond the paper it is nearly three times as bright as the paper: 1.2 cells away, nearer than the
  // library's threshold looks.
  const TagPattern pattern = TagFamily::get("tag36h11").pattern(128);
  const PlaneView view(500.0, {79.6, 79.7}, 1.1, 0.3, 0.8, 0.1);
  const double paper = 1.0 + 1.2 * pattern.cell_size();
  const auto brightness = [&](double x, double y) {
    const double u = 2.0 * x / kTagSize_m, v = 2.0 * y / kTagSize_m;
    return std::max(std::abs(u), std::abs(v)) > paper ? 1.0 : 0.35 * pattern.brightness(u, v);
  };
  for (const bool is_srgb : {true, false}) {
    test::RenderOptions options;
    options.black_light = 0.02;
    options.white_light = 0.95;
    options.is_srgb = is_srgb;
    const GrayImage image = test::render_plane(160, 160, view, brightness, options);
    const auto found = Detector({.response = is_srgb ? ResponseCurve::srgb() : ResponseCurve::linear()})
                           .detect(image.view());
    ASSERT_EQ(found.size(), 1U) << is_srgb;
    EXPECT_EQ(found[0].tag.id, 128);
    const std::size_t found_in_raw_image =
        Detector({.response = ResponseCurve::linear(), .search_raw_image_only = true})
            .detect(image.view())
            .size();
    EXPECT_EQ(found_in_raw_image, is_srgb ? 1U : 0U);
    for (std::size_t k = 0; k < kNumCorners; ++k)
      EXPECT_LT((found[0].corners_px[k] - view.to_pixel(tag_corners(kTagSize_m)[k].head<2>())).norm(), 0.1);
  }
}

std::string refusal_of(const DetectorOptions& options) {
  try {
    Detector detector(options);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kInvalidInput);
    return error.what();
  }
  return "accepted";
}

TEST(DetectorOptions, RefusalsNameTheOptionTheValueAndTheRange) {
  EXPECT_THAT(refusal_of({.families = {}}), HasSubstr("families"));
  EXPECT_THAT(refusal_of({.families = {"tag36h12"}}), HasSubstr("tag36h11"));
  EXPECT_THAT(refusal_of({.families = {"tag36h11", "tag36h11"}}), HasSubstr("once"));
  for (const double decimate : {0.5, 0.0, -1.0, 2.5, 9.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THAT(refusal_of({.decimate = decimate}), HasSubstr("decimate must be"));
  for (const double margin : {-1.0, 256.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THAT(refusal_of({.min_decision_margin = margin}), HasSubstr("[0, 255]"));
  for (const int hamming : {-1, 3}) EXPECT_THAT(refusal_of({.max_hamming = hamming}), HasSubstr("[0, 2]"));
}

TEST(DetectorOptions, DecimateFindsLargeTagsJustAsWellPlaced) {
  const GrayImage image = render_nine(0.002);
  Detector full({});
  const auto expected = full.detect(image.view());
  for (const double decimate : {1.5, 2.0}) {
    Detector detector({.decimate = decimate});
    const auto detections = detector.detect(image.view());
    ASSERT_EQ(detections.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i)
      for (std::size_t k = 0; k < kNumCorners; ++k)
        EXPECT_LT((detections[i].corners_px[k] - expected[i].corners_px[k]).norm(), 0.1);
  }
}

}  // namespace
}  // namespace apriltrack
