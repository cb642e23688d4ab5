// Grid, levels, shades, legend and letters of a chart, read back as a picture.
#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "apriltrack/base/check.h"
#include "apriltrack/report/chart.h"
#include "picture_marks.h"
#include "support/shared_data.h"

namespace apriltrack {
namespace {

using test::middle_of;

ChartSeries points(Colour colour, std::vector<double> x, std::vector<double> y,
                   std::vector<double> shade = {}) {
  return {"", colour, ChartMark::kPoints, std::move(x), std::move(y), std::move(shade)};
}

Chart chart_to(double x_high, double y_high) {
  Chart chart;
  chart.x = {"", false, 0.0, x_high, false};
  chart.y = {"", false, 0.0, y_high, false};
  chart.series = {points(kOrange, {0.0}, {0.0}), points(kBlue, {x_high}, {y_high})};
  return chart;
}

cv::Point pixel_at(const cv::Mat& picture, double x, double y) {
  const cv::Point2d low = middle_of(picture, kOrange);
  const cv::Point2d high = middle_of(picture, kBlue);
  return {cvRound(low.x + x * (high.x - low.x)), cvRound(low.y + y * (high.y - low.y))};
}

int darkness(const cv::Mat& picture, cv::Rect area) {
  cv::Mat grey;
  cv::cvtColor(picture(area), grey, cv::COLOR_BGR2GRAY);
  double min = 255.0;
  cv::minMaxLoc(grey, &min);
  return 255 - static_cast<int>(min);
}

/// Groups of columns with ink, at least `gap` white columns apart.
int count_groups(const cv::Mat& picture, cv::Rect area, int gap) {
  int groups = 0;
  int num_white = gap;
  for (int x = area.x; x < area.br().x; ++x) {
    const bool has_ink = darkness(picture, {x, area.y, 1, area.height}) > 40;
    if (has_ink && num_white >= gap) ++groups;
    num_white = has_ink ? 0 : num_white + 1;
  }
  return groups;
}

TEST(ChartMarks, GridLiesOnRoundNumbers) {
  const cv::Mat picture = test::drawn(chart_to(10.0, 100.0));
  for (int k = 1; k < 10; ++k) {
    const cv::Point on = pixel_at(picture, 0.1 * k, 0.53);
    const cv::Point between = pixel_at(picture, 0.1 * k + 0.05, 0.53);
    EXPECT_GT(darkness(picture, {on.x - 1, on.y - 5, 3, 10}), 10) << k;
    EXPECT_EQ(darkness(picture, {between.x - 20, between.y - 5, 40, 10}), 0) << k;
  }
  const cv::Point level = pixel_at(picture, 0.53, 0.4);  // y = 40
  EXPECT_GT(darkness(picture, {level.x - 5, level.y - 1, 10, 3}), 10);
}

TEST(ChartMarks, EveryTickHasALabelOfItsOwn) {
  const cv::Mat picture = test::drawn(chart_to(1.0, 100.0));
  const cv::Point foot = pixel_at(picture, 0.0, 0.0);
  constexpr int kLetterGap = 10;
  EXPECT_EQ(count_groups(picture, {0, foot.y + 6, picture.cols, 18}, kLetterGap), 11) << "0.0, 0.1 ... 1.0";
}

TEST(ChartMarks, LongLabelsDoNotRunIntoEachOther) {
  Chart chart = chart_to(1.0, 100.0);
  chart.x = {"", false, 1403636579.25, 1403636581.25, false};  // seconds since 1970
  for (ChartSeries& series : chart.series) series.x[0] += 1403636579.25;
  chart.series[1].x[0] = 1403636581.25;
  const cv::Mat picture = test::drawn(chart);
  const cv::Point foot = pixel_at(picture, 0.0, 0.0);
  const cv::Rect band(0, foot.y + 6, picture.cols, 18);
  const int num_labels = count_groups(picture, band, 10);
  EXPECT_GE(num_labels, 2);
  EXPECT_EQ(count_groups(picture, band, 16), num_labels) << "clearly apart";
}

TEST(ChartMarks, LevelsAreDashedLinesAcross) {
  Chart chart = chart_to(10.0, 10.0);
  chart.levels = {{7.3, "limit"}, {70.0, "beyond the axis"}};
  const cv::Mat picture = test::drawn(chart);
  const cv::Point start = pixel_at(picture, 0.31, 0.73);
  int num_dark = 0;
  int num_white = 0;
  for (int x = 0; x < 60; ++x) {  // between the grid's lines at 3 and 4
    const int ink = darkness(picture, {start.x + x, start.y - 1, 1, 3});
    num_dark += ink > 100 ? 1 : 0;
    num_white += ink == 0 ? 1 : 0;
  }
  EXPECT_GT(num_dark, 20);
  EXPECT_GT(num_white, 15);
  const cv::Point end = pixel_at(picture, 0.99, 0.73);
  EXPECT_GT(darkness(picture, {end.x - 40, end.y - 14, 40, 10}), 100) << "its name at its right end";
}

TEST(ChartMarks, ShadesAreViridisFromYellowToViolet) {
  const Colour kLow{253, 231, 37};  // the two ends and the middle of viridis (matplotlib 1.5, 2015)
  const Colour kMiddle{33, 145, 140};
  const Colour kHigh{68, 1, 84};
  Chart chart = chart_to(10.0, 10.0);
  chart.shade_label = "weight";
  chart.series.push_back(points(kBlack, {2.5, 5.0, 7.5}, {5.0, 5.0, 5.0}, {0.0, 0.5, 1.0}));
  const cv::Mat picture = test::drawn(chart);
  for (const auto& [colour, x] : {std::pair(kLow, 0.25), std::pair(kMiddle, 0.5), std::pair(kHigh, 0.75)}) {
    const cv::Point at = pixel_at(picture, x, 0.5);
    EXPECT_TRUE(test::shows(picture({at.x - 1, at.y - 1, 3, 3}), colour)) << x;
  }
  const cv::Mat beside = picture.colRange(pixel_at(picture, 1.0, 1.0).x + 10, picture.cols);
  EXPECT_LT(middle_of(beside, kHigh).y, middle_of(beside, kMiddle).y) << "a bar of the colours, 1 on top";
  EXPECT_LT(middle_of(beside, kMiddle).y, middle_of(beside, kLow).y);
}

TEST(ChartMarks, GreaterShadesLieOnTop) {
  Chart chart = chart_to(10.0, 10.0);
  chart.series.push_back(points(kBlack, {5.0, 5.0, 5.0}, {5.0, 5.0, 5.0}, {0.3, 1.0, 0.0}));
  const cv::Mat picture = test::drawn(chart);
  const cv::Point at = pixel_at(picture, 0.5, 0.5);
  EXPECT_TRUE(test::shows(picture({at.x, at.y, 1, 1}), Colour{68, 1, 84}));
}

TEST(ChartMarks, RingsAndCrossesLeaveInSightWhatLiesBelow) {
  constexpr int kReach = 6;
  for (const ChartMark mark : {ChartMark::kRings, ChartMark::kCrosses}) {
    Chart chart = chart_to(10.0, 10.0);
    chart.series.push_back(points(kBluishGreen, {5.0}, {5.5}));
    chart.series.push_back({"", kVermilion, mark, {5.0}, {5.5}, {}});
    const cv::Mat picture = test::drawn(chart);
    const cv::Point at = pixel_at(picture, 0.5, 0.55);
    const cv::Mat around = picture({at.x - kReach, at.y - kReach, 2 * kReach + 1, 2 * kReach + 1});
    EXPECT_TRUE(test::shows(around, kVermilion));
    EXPECT_TRUE(test::shows(around, kBluishGreen)) << "the point below";
    EXPECT_EQ(test::shows(picture({at.x, at.y, 1, 1}), kBluishGreen), mark == ChartMark::kRings)
        << "its middle";
    const cv::Rect drawn = cv::boundingRect(test::mask_of(around, kVermilion));
    EXPECT_NEAR(drawn.width, 7, 2) << "as large as a point";
    EXPECT_NEAR(drawn.x + 0.5 * drawn.width, kReach + 0.5, 1.0) << "about the same place";
  }
}

TEST(ChartMarks, TranslucentPointsAreDarkerTheMoreOfThemThereAre) {
  const auto grey_of = [](std::size_t num_points) {
    Chart chart = chart_to(10.0, 10.0);
    const std::vector<double> at(num_points, 5.5);
    chart.series.push_back(points(kBlack, at, at));
    chart.series.back().opacity = 0.5;
    const cv::Mat picture = test::drawn(chart);
    return 255 - darkness(picture, {pixel_at(picture, 0.55, 0.55), cv::Size(1, 1)});
  };
  EXPECT_NEAR(grey_of(1), 128, 3);  // half of white
  EXPECT_NEAR(grey_of(2), 64, 3);
  EXPECT_NEAR(grey_of(6), 4, 3);
}

TEST(ChartMarks, ChartsAreAsLargeAsAskedFor) {
  Chart chart = chart_to(10.0, 10.0);
  const cv::Mat usual = test::drawn(chart);
  ASSERT_EQ(usual.size(), cv::Size(1200, 560));
  chart.width = 800;
  chart.plot_height = 600;
  const cv::Mat picture = test::drawn(chart);
  EXPECT_EQ(picture.size(), cv::Size(800, 560 + 600 - 372));
  EXPECT_NEAR(middle_of(picture, kOrange).y - middle_of(picture, kBlue).y, 600.0, 1.5) << "from end to end";
  EXPECT_NEAR(middle_of(picture, kBlue).x, 800.0 - 60.0, 1.5) << "up to the margin";
  chart.width = 399;
  EXPECT_THROW(chart_png(chart), MisuseError);
  chart.width = 800;
  chart.plot_height = 0;
  EXPECT_THROW(chart_png(chart), MisuseError);
  chart.plot_height = 600;
  chart.series[0].opacity = 0.0;
  EXPECT_THROW(chart_png(chart), MisuseError);
}

TEST(ChartMarks, LegendNamesWhatIsEmpty) {
  const auto legend_width = [](std::vector<double> numbers) {
    Chart chart;
    chart.series = {{"method", kVermilion, ChartMark::kLine, numbers, numbers, {}}};
    const cv::Mat picture = test::drawn(chart);
    const cv::Mat row = picture.rowRange(58, 80);
    EXPECT_TRUE(test::shows(row, kVermilion)) << "a sample of the line";
    cv::Mat ink;
    cv::inRange(row, cv::Scalar::all(0), cv::Scalar::all(200), ink);
    return cv::boundingRect(ink).width;
  };
  const double not_a_number = std::numeric_limits<double>::quiet_NaN();
  const int full = legend_width({1.0, 2.0});
  EXPECT_GT(legend_width({}), full + 40) << "(none)";
  EXPECT_EQ(legend_width({not_a_number}), legend_width({}));
}

TEST(ChartMarks, ManyNamesTakeMoreRows) {
  Chart chart;
  for (int i = 0; i < 12; ++i)
    chart.series.push_back({"a method with a rather long name", kBlack, ChartMark::kLine, {1.0}, {1.0}, {}});
  EXPECT_GT(test::drawn(chart).rows, 560);
  chart.series = {{std::string(500, 'w'), kBlack, ChartMark::kLine, {1.0}, {1.0}, {}}};
  const cv::Mat picture = test::drawn(chart);
  EXPECT_EQ(picture.rows, 560);
  EXPECT_EQ(darkness(picture, {1150, 55, 50, 30}), 0) << "cut short before the margin";
}

}  // namespace
}  // namespace apriltrack
