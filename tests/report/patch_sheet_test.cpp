#include "apriltrack/report/patch_sheet.h"

#include <gtest/gtest.h>

#include <limits>
#include <opencv2/imgproc.hpp>

#include "apriltrack/base/check.h"
#include "apriltrack/base/error.h"
#include "picture_marks.h"
#include "support/shared_data.h"

namespace apriltrack {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

cv::Mat drawn(const std::vector<LabelledPatch>& patches) {
  const auto file = test::temporary_folder() / "patches.png";
  write_patch_sheet(file, "title", patches);
  return test::read_picture(file);
}

cv::Rect area_of_grey(const cv::Mat& picture, int level) {
  const auto grey = static_cast<std::uint8_t>(level);
  return cv::boundingRect(test::mask_of(picture, {grey, grey, grey}, 0));
}

/// Grey levels that nothing else on the sheet has.
Image<float> four_levels() {
  Image<float> cells(2, 2);
  cells(0, 0) = 11.0f;
  cells(1, 0) = 81.0f;
  cells(0, 1) = 151.0f;
  cells(1, 1) = 201.4f;
  return cells;
}

TEST(PatchSheet, CellsAreSquaresOfWholePixelsAndOneGrey) {
  const cv::Mat picture = drawn({{four_levels(), "one"}});
  const cv::Rect first = area_of_grey(picture, 11);
  EXPECT_EQ(first.width, first.height);
  EXPECT_GE(first.width, 50) << "a single patch is shown large";
  const cv::Point right(first.width, 0);
  const cv::Point down(0, first.height);
  EXPECT_EQ(area_of_grey(picture, 81), first + right);
  EXPECT_EQ(area_of_grey(picture, 151), first + down);
  EXPECT_EQ(area_of_grey(picture, 201), first + right + down) << "rounded";
  const cv::Mat cell = picture(first);
  EXPECT_EQ(cv::countNonZero(test::mask_of(cell, {11, 11, 11}, 0)), first.area()) << "not smoothed";
}

TEST(PatchSheet, LevelsBeyondEightBitsAreBlackAndWhite) {
  Image<float> cells(2, 1);
  cells(0, 0) = -40.0f;
  cells(1, 0) = 300.0f;
  const cv::Mat picture = drawn({{cells, ""}});
  const cv::Rect black = area_of_grey(picture, 0);
  EXPECT_GT(black.area(), 2500);
  const cv::Rect white = black + cv::Point(black.width, 0);
  EXPECT_EQ(cv::countNonZero(test::mask_of(picture(white), {255, 255, 255}, 0)), white.area());
}

TEST(PatchSheet, WhatIsNotKnownIsAPaleHatch) {
  Image<float> cells(2, 1, 11.0f);
  cells(1, 0) = kUnknown;
  const cv::Mat picture = drawn({{cells, ""}});
  const cv::Rect known = area_of_grey(picture, 11);
  const cv::Rect unknown = known + cv::Point(known.width, 0);
  cv::Mat grey;
  cv::cvtColor(picture(unknown), grey, cv::COLOR_BGR2GRAY);
  double min = 0.0;
  double max = 0.0;
  cv::minMaxLoc(grey, &min, &max);
  EXPECT_GT(min, 200.0) << "pale";
  EXPECT_GT(max - min, 20.0) << "and no plain white";
  EXPECT_EQ(cv::norm(grey.row(0).colRange(6, 60), grey.row(3).colRange(3, 57), cv::NORM_INF), 0.0)
      << "slanted";
}

TEST(PatchSheet, ManyPatchesStandInRowsInTheirOrder) {
  std::vector<LabelledPatch> patches;
  for (int i = 0; i < 10; ++i) patches.push_back({Image<float>(20, 20, 21.0f + 10.0f * i), "patch"});
  const cv::Mat picture = drawn(patches);
  EXPECT_EQ(picture.cols, 1200);
  cv::Rect last;
  int num_rows = 1;
  for (int i = 0; i < 10; ++i) {
    const cv::Rect area = area_of_grey(picture(cv::Rect(0, 60, 1200, picture.rows - 60)), 21 + 10 * i);
    ASSERT_GE(area.width, 100) << i;
    if (i > 0 && area.y > last.br().y) {
      ++num_rows;
    } else if (i > 0) {
      EXPECT_EQ(area.y, last.y);
      EXPECT_GT(area.x, last.br().x + 10);
    }
    last = area;
  }
  EXPECT_EQ(num_rows, 2);
}

TEST(PatchSheet, PatchLargerThanTheSheetIsNotShrunk) {
  const cv::Mat picture = drawn({{Image<float>(1500, 40, 11.0f), "wide"}});
  EXPECT_EQ(area_of_grey(picture, 11).size(), cv::Size(1500, 40));
}

TEST(PatchSheet, NothingToShowIsMisuse) {
  EXPECT_THROW(drawn({}), MisuseError);
  EXPECT_THROW(drawn({{Image<float>(), "empty"}}), MisuseError);
}

TEST(PatchSheet, UnwritablePlaceIsAnIoError) {
  const LabelledPatch patch{four_levels(), ""};
  try {
    write_patch_sheet(test::temporary_folder() / "missing" / "x.png", "", {&patch, 1});
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kIo);
  }
}

}  // namespace
}  // namespace apriltrack
