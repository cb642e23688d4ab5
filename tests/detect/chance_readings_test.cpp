// Readings of tags that are not there, by families of few bits.

#include "apriltrack/detect/chance_readings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "apriltrack/base/random.h"
#include "apriltrack/detect/detector.h"
#include "merge.h"
#include "pattern_correlation.h"
#include "plane_renderer.h"

namespace apriltrack {
namespace {

using test::PlaneView;

/// The data bits of a tag16h5 (four by four cells within the border), turned by so many right angles.
std::uint32_t bits_of_16h5(int id, int turns) {
  constexpr int kBits = 4;
  const TagPattern pattern = TagFamily::get("tag16h5").pattern(id);
  const int first = (pattern.cells().width() - kBits) / 2;
  std::uint32_t bits = 0;
  for (int row = 0; row < kBits; ++row) {
    for (int column = 0; column < kBits; ++column) {
      int x = column, y = row;
      for (int i = 0; i < turns; ++i) {
        const int old_x = x;
        x = kBits - 1 - y;
        y = old_x;
      }
      bits = bits << 1 | (pattern.cells()(first + x, first + y) > 0.5F);
    }
  }
  return bits;
}

TEST(ChanceReadings, AreTheShareOfAllBitPatternsThatAreReadAsACode) {
  const TagFamily& family = TagFamily::get("tag16h5");
  std::vector<std::uint32_t> codes;
  for (int id = 0; id < family.num_codes(); ++id)
    for (int turns = 0; turns < 4; ++turns) codes.push_back(bits_of_16h5(id, turns));
  for (const int corrected : {0, 1, 2}) {
    int read = 0;
    for (std::uint32_t bits = 0; bits < 1u << 16; ++bits)
      read += std::ranges::any_of(
          codes, [&](std::uint32_t code) { return std::popcount(bits ^ code) <= corrected; });
    EXPECT_DOUBLE_EQ(family.chance_of_reading(corrected), read / 65536.0) << corrected;
  }
}

TEST(ChanceReadings, LimitTheCorrectedBitsOfEachFamily) {
  struct Limit {
    const char* family;
    int by_code, by_picture;
  };
  for (const auto& [name, by_code, by_picture] : {Limit{"tag16h5", -1, 0},
                                                  {"tag25h9", 0, 2},
                                                  {"tagCircle21h7", -1, 1},
                                                  {"tag36h10", 1, 2},
                                                  {"tag36h11", 2, 2},
                                                  {"tagStandard41h12", 2, 2},
                                                  {"tagStandard52h13", 1, 1}}) {
    const TagFamily& family = TagFamily::get(name);
    EXPECT_EQ(corrected_bits_by_code(family), by_code) << name;
    EXPECT_EQ(corrected_bits_by_picture(family), by_picture) << name;
    EXPECT_LE(chance_readings_per_frame(family, 2), kMostChanceReadings * 1.5) << name;
  }
}

/// A wall of eight by eight tags, or what looks like tags, all different.
GrayImage wall_of(const std::vector<TagPattern>& squares) {
  constexpr double kPitch_m = 0.15, kSquare_m = 0.1;
  constexpr int kColumns = 8;
  const auto brightness = [&](double x, double y) {
    const double column = x / kPitch_m + 0.5 * kColumns, row = y / kPitch_m + 0.5 * kColumns;
    if (column < 0.0 || row < 0.0 || column >= kColumns || row >= kColumns) return 1.0;
    const double scale = 2.0 * kPitch_m / kSquare_m;
    const auto square = static_cast<std::size_t>(row) * kColumns + static_cast<std::size_t>(column);
    return squares[square].brightness(scale * (column - std::floor(column) - 0.5),
                                      scale * (row - std::floor(row) - 0.5));
  };
  test::RenderOptions options;
  options.samples = 2;
  return test::render_plane(640, 480, PlaneView(500.0, {319.6, 239.7}, 1.4, 0.3, 0.8, 0.1), brightness,
                            options);
}

std::vector<TagPattern> tags_of_another_family() {
  std::vector<TagPattern> tags;
  for (int id = 0; id < 64; ++id) tags.push_back(TagFamily::get("tag36h11").pattern(9 * id));
  return tags;
}

/// The worst that there can be: black borders on paper as tags have them, and four by four cells of any grey.
std::vector<TagPattern> squares_of_grey_cells(std::uint64_t seed) {
  RandomStream random(seed);
  std::vector<TagPattern> squares;
  for (int i = 0; i < 64; ++i) {
    Image<float> cells(6, 6);
    for (int y = 1; y < 5; ++y)
      for (int x = 1; x < 5; ++x) cells(x, y) = static_cast<float>(random.uniform(0.0, 1.0));
    squares.emplace_back(std::move(cells), 6);
  }
  return squares;
}

std::size_t readings_in(const GrayImage& image, const DetectorOptions& options) {
  return Detector(options).detect(image.view()).size();
}

TEST(ChanceReadings, OfFewBitsAreDroppedWhereThePictureIsNotTheTags) {
  const GrayImage others = wall_of(tags_of_another_family());
  EXPECT_GE(readings_in(others, {.families = {"tag16h5"}, .max_hamming = 2}), 5U);
  EXPECT_EQ(readings_in(others, {.families = {"tag16h5"}}), 0U);
  EXPECT_EQ(readings_in(others, {.families = {"tag16h5"}, .max_hamming = 0}), 0U)
      << "a lower limit is no risk";
  std::size_t anyhow = 0, by_default = 0;
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    const GrayImage image = wall_of(squares_of_grey_cells(seed));
    anyhow += readings_in(image, {.families = {"tag16h5"}, .max_hamming = 2});
    by_default += readings_in(image, {.families = {"tag16h5"}});
    EXPECT_EQ(readings_in(image, {.families = {"tag25h9", "tagCircle21h7"}}), 0U);
  }
  EXPECT_GE(anyhow, 80U);
  EXPECT_LE(by_default, 4U) << "of 256 squares with tags' borders";
}

struct SmallTag {
  double width_px = 40.0;
  double tilt_rad = 0.5;
  double blur_px = 0.6;
  double motion_px = 0.0;
  double shadow = 1.0;  ///< Light left in one half of the tag.
};

GrayImage picture_of(const TagPattern& pattern, const SmallTag& tag) {
  constexpr double kEdge_m = 0.1;
  const PlaneView view(600.0, {79.6, 80.3}, 600.0 * kEdge_m / tag.width_px, tag.tilt_rad, 0.9, 0.4);
  test::RenderOptions options;
  options.blur_sigma_px = tag.blur_px;
  options.motion_px = {0.8 * tag.motion_px, 0.6 * tag.motion_px};
  return test::render_plane(
      160, 160, view,
      [&](double x, double y) {
        return pattern.brightness(2.0 * x / kEdge_m, 2.0 * y / kEdge_m) * (x < 0.3 * y ? tag.shadow : 1.0);
      },
      options);
}

TEST(ChanceReadings, LeaveTagsOfFewBitsReadableAtTheirLimits) {
  Detector detector({.families = {"tag16h5"}});
  Detector any({.families = {"tag16h5"}, .max_hamming = 2});
  int read = 0;
  for (const SmallTag& tag :
       {SmallTag{}, SmallTag{.width_px = 14.0}, SmallTag{.tilt_rad = 1.1}, SmallTag{.blur_px = 2.0},
        SmallTag{.motion_px = 6.0}, SmallTag{.shadow = 0.6}}) {
    for (const int id : {0, 7, 29}) {
      const GrayImage image = picture_of(TagFamily::get("tag16h5").pattern(id), tag);
      const auto expected = any.detect(image.view());
      const auto detections = detector.detect(image.view());
      EXPECT_EQ(detections.size(), expected.size())
          << id << ": " << tag.width_px << " px, " << tag.blur_px << " px of blur, light " << tag.shadow;
      read += static_cast<int>(detections.size());
    }
  }
  EXPECT_GE(read, 15);
}

TEST(PatternCorrelation, IsOneOfTheTagItselfAndLessOfAnother) {
  const TagFamily& family = TagFamily::get("tag16h5");
  const TagPattern pattern = family.pattern(3);
  const GrayImage image = picture_of(pattern, {});
  const auto detections = Detector({.families = {"tag16h5"}}).detect(image.view());
  ASSERT_EQ(detections.size(), 1U);
  const LightSampler light(image.view(), ResponseCurve::srgb());
  const Quad& corners_px = detections[0].corners_px;
  EXPECT_GT(pattern_correlation(light, pattern, false, corners_px), 0.98);
  for (int id = 0; id < family.num_codes(); ++id) {
    if (id == 3) continue;
    EXPECT_LT(pattern_correlation(light, family.pattern(id), false, corners_px), 0.9) << id;
  }
  Quad outside = corners_px;
  for (Eigen::Vector2d& corner : outside) corner.x() += 130.0;
  EXPECT_EQ(pattern_correlation(light, pattern, false, outside), 0.0) << "cut by the image";
}

TEST(ChanceReadings, OfACodeWhoseCellsLookOtherwiseAreLeftOut) {
  // In the middle of each cell, where it is read, the bits of a code; round that their opposite.
  const TagPattern pattern = TagFamily::get("tag16h5").pattern(3);
  constexpr int kParts = 3, kWidth = 6;
  const int margin = (pattern.cells().width() - kWidth) / 2;
  Image<float> cells(kParts * kWidth, kParts * kWidth);
  for (int y = 0; y < cells.height(); ++y) {
    for (int x = 0; x < cells.width(); ++x) {
      const int column = x / kParts, row = y / kParts;
      const float bit = pattern.cells()(column + margin, row + margin);
      const bool is_border = std::min({column, row, kWidth - 1 - column, kWidth - 1 - row}) == 0;
      const bool is_middle = x % kParts == 1 && y % kParts == 1;
      cells(x, y) = is_border || is_middle ? bit : 1.0F - bit;
    }
  }
  const GrayImage image = picture_of(TagPattern(std::move(cells), kParts * kWidth), {.width_px = 90.0});
  ASSERT_EQ(readings_in(image, {.families = {"tag16h5"}, .max_hamming = 2}), 1U);
  const FoundTags found = Detector({.families = {"tag16h5"}}).find(image.view());
  EXPECT_TRUE(found.detections.empty());
  ASSERT_EQ(found.left_out.size(), 1U);
  EXPECT_EQ(found.left_out[0].reading.tag, (TagKey{"tag16h5", 3}));
  EXPECT_EQ(found.left_out[0].reason, LeftOutReason::kMayBeChance);
}

TEST(ChanceReadings, OfTwoReadingsOfASquareTheOneStaysThatChanceMakesMoreSeldom) {
  const Quad square = {Eigen::Vector2d(10.0, 60.0), {60.0, 60.0}, {60.0, 10.0}, {10.0, 10.0}};
  const Candidate with_a_wrong_bit = {.detection = {{"tag36h11", 17}, square, 1, 40.0}};
  const Candidate of_few_bits = {.detection = {{"tag16h5", 3}, square, 0, 90.0}};
  const auto kept = merge_same_quads({of_few_bits, with_a_wrong_bit});
  ASSERT_EQ(kept.size(), 1U);
  EXPECT_EQ(kept[0].detection.tag, (TagKey{"tag36h11", 17}));
}

}  // namespace
}  // namespace apriltrack
