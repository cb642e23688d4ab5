// The pale band behind a line, read back as a picture.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "apriltrack/base/check.h"
#include "apriltrack/io/atomic_file.h"
#include "apriltrack/report/chart.h"
#include "apriltrack/report/html_page.h"
#include "picture_marks.h"
#include "support/shared_data.h"

namespace apriltrack {
namespace {

constexpr double kGap = std::numeric_limits<double>::quiet_NaN();

/// A line at 0 from 0 to 10, and points in two corners by which places are found.
struct BandChart {
  explicit BandChart(std::vector<double> y, std::vector<double> half_width) {
    Chart chart;
    chart.x = {"", false, 0.0, 10.0, false};
    chart.y = {"", false, -2.0, 2.0, false};
    chart.series = {{"", kOrange, ChartMark::kPoints, {0.0}, {-2.0}, {}},
                    {"", kVermilion, ChartMark::kPoints, {10.0}, {2.0}, {}},
                    {"", kBlue, ChartMark::kLine, {0.0, 4.0, 6.0, 10.0}, std::move(y), {}}};
    chart.series.back().half_width = std::move(half_width);
    picture = test::drawn(chart);
    low = test::middle_of(picture, kOrange);
    high = test::middle_of(picture, kVermilion);
  }
  /// Neither white paper nor the grid's grey.
  bool is_bluish(double x, double y) const {
    const cv::Point at(cvRound(low.x + x / 10.0 * (high.x - low.x)),
                       cvRound(low.y + (y + 2.0) / 4.0 * (high.y - low.y)));
    const auto& bgr = picture.at<cv::Vec3b>(at);
    return bgr[0] - bgr[2] > 25;
  }

  cv::Mat picture;
  cv::Point2d low, high;
};

TEST(ChartBand, ReachesAsFarAsItsHalfWidth) {
  const BandChart chart({0.0, 0.0, 0.0, 0.0}, {1.0, 1.0, 1.0, 1.0});
  for (const double x : {0.3, 2.3, 5.3, 9.7}) {
    for (const double y : {-0.93, -0.3, 0.3, 0.93}) EXPECT_TRUE(chart.is_bluish(x, y)) << x << " " << y;
    for (const double y : {-1.07, 1.07}) EXPECT_FALSE(chart.is_bluish(x, y)) << x << " " << y;
  }
}

TEST(ChartBand, WidensBetweenPoints) {
  const BandChart chart({0.0, 0.0, 0.0, 0.0}, {0.0, 1.6, 1.6, 0.0});
  EXPECT_TRUE(chart.is_bluish(2.0, 0.73));  // half of 1.6 is 0.8
  EXPECT_FALSE(chart.is_bluish(2.0, 0.87));
}

TEST(ChartBand, HasTheGapsOfItsLineAndOfItsOwn) {
  const BandChart of_line({0.0, kGap, 0.0, 0.0}, {1.0, 1.0, 1.0, 1.0});
  EXPECT_FALSE(of_line.is_bluish(2.3, 0.3));
  EXPECT_FALSE(of_line.is_bluish(5.3, 0.3));
  EXPECT_TRUE(of_line.is_bluish(8.3, 0.3));
  const BandChart of_band({0.0, 0.0, 0.0, 0.0}, {kGap, 1.0, 1.0, 1.0});
  EXPECT_FALSE(of_band.is_bluish(2.3, 0.3));
  EXPECT_TRUE(of_band.is_bluish(5.3, 0.3));
}

TEST(ChartBand, EndsWithTheAxis) {
  const BandChart chart({0.0, 0.0, 0.0, 0.0}, {1e3, 1e3, 1e3, 1e3});
  EXPECT_TRUE(chart.is_bluish(5.3, 1.9));
  EXPECT_FALSE(chart.is_bluish(5.3, 2.1));
  EXPECT_FALSE(chart.is_bluish(5.3, -2.1));
}

TEST(ChartBand, LetsAnotherShowThrough) {
  Chart chart;
  chart.x = {"", false, 0.0, 10.0, false};
  chart.y = {"", false, -2.0, 2.0, false};
  chart.series = {{"", kOrange, ChartMark::kPoints, {0.0}, {-2.0}, {}},
                  {"", kBluishGreen, ChartMark::kPoints, {10.0}, {2.0}, {}},
                  {"", kBlue, ChartMark::kLine, {0.0, 10.0}, {0.0, 0.0}, {}},
                  {"", kVermilion, ChartMark::kLine, {0.0, 10.0}, {1.0, 1.0}, {}}};
  for (const std::size_t i : {2U, 3U}) chart.series[i].half_width = {0.9, 0.9};
  const cv::Mat picture = test::drawn(chart);
  const cv::Point2d low = test::middle_of(picture, kOrange), high = test::middle_of(picture, kBluishGreen);
  const auto colour_at = [&](double y) {
    return picture.at<cv::Vec3b>(cv::Point(cvRound(low.x + 0.53 * (high.x - low.x)),
                                           cvRound(low.y + (y + 2.0) / 4.0 * (high.y - low.y))));
  };
  const cv::Vec3b blue = colour_at(-0.45), both = colour_at(0.45), vermilion = colour_at(1.55);
  EXPECT_LT(both[0], blue[0] - 20) << "vermilion takes away blue";
  EXPECT_LT(both[2], vermilion[2] - 20) << "blue takes away red";
}

TEST(ChartBand, MisuseIsRefused) {
  Chart chart;
  chart.series = {{"", kBlue, ChartMark::kLine, {0.0, 1.0}, {0.0, 1.0}, {}}};
  chart.series.back().half_width = {1.0};
  EXPECT_THROW(chart_png(chart), MisuseError);
  chart.series.back().half_width = {1.0, -1.0};
  EXPECT_THROW(chart_png(chart), MisuseError);
}

TEST(ChartPng, IsTheFileThatIsWritten) {
  Chart chart;
  chart.series = {{"", kBlue, ChartMark::kLine, {0.0, 1.0}, {0.0, 1.0}, {}}};
  const auto file = test::temporary_folder() / "chart.png";
  write_chart(file, chart);
  EXPECT_EQ(chart_png(chart), read_file(file));
  HtmlPage from_file("page"), from_bytes("page");
  from_file.picture(file, "a chart");
  from_bytes.png(chart_png(chart), "a chart");
  EXPECT_EQ(from_bytes.html(), from_file.html());
}

}  // namespace
}  // namespace apriltrack
