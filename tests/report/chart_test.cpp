// Charts are read back as pictures: points at the ends of both axes tell where the plot lies, and what is
// between must lie where the linear or logarithmic map says.
#include "apriltrack/report/chart.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "apriltrack/base/check.h"
#include "apriltrack/base/error.h"
#include "picture_marks.h"
#include "support/shared_data.h"

namespace apriltrack {
namespace {

using test::middle_of;
using test::shows;

constexpr double kMaxChartError_px = 0.5;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

ChartSeries point(Colour colour, double x, double y) {
  return {"", colour, ChartMark::kPoints, {x}, {y}, {}};
}

/// From (0, -5) to (10, 5), an orange and a blue point in the corners.
Chart linear_chart() {
  Chart chart;
  chart.x = {"x", false, 0.0, 10.0, false};
  chart.y = {"y", false, -5.0, 5.0, false};
  chart.series = {point(kOrange, 0.0, -5.0), point(kBlue, 10.0, 5.0)};
  return chart;
}

/// Where the fractions of the axes lie in a chart with those two points.
cv::Point2d place(const cv::Mat& picture, double x, double y) {
  const cv::Point2d low = middle_of(picture, kOrange);
  const cv::Point2d high = middle_of(picture, kBlue);
  return {low.x + x * (high.x - low.x), low.y + y * (high.y - low.y)};
}

void expect_at(const cv::Mat& picture, const Colour& colour, double x, double y) {
  const cv::Point2d found = middle_of(picture, colour);
  EXPECT_NEAR(found.x, place(picture, x, y).x, kMaxChartError_px);
  EXPECT_NEAR(found.y, place(picture, x, y).y, kMaxChartError_px);
}

bool has_colour_at(const cv::Mat& picture, const Colour& colour, cv::Point2d at) {
  const cv::Rect around(cvRound(at.x) - 1, cvRound(at.y) - 1, 3, 3);
  return shows(picture(around), colour);
}

TEST(Chart, PointsLieWhereALinearMapPutsThem) {
  Chart chart = linear_chart();
  chart.series.push_back(point(kBluishGreen, 2.5, 2.0));
  chart.series.push_back(point(kReddishPurple, 8.1, -4.3));
  const cv::Mat picture = test::drawn(chart);
  EXPECT_EQ(picture.size(), cv::Size(1200, 560));
  EXPECT_GT(place(picture, 1.0, 1.0).x, place(picture, 0.0, 0.0).x + 800.0) << "a wide plot, x to the right";
  EXPECT_LT(place(picture, 1.0, 1.0).y, place(picture, 0.0, 0.0).y - 300.0) << "y upwards";
  expect_at(picture, kBluishGreen, 0.25, 0.7);
  expect_at(picture, kReddishPurple, 0.81, 0.07);
}

TEST(Chart, PointsLieWhereALogarithmicMapPutsThem) {
  Chart chart;
  chart.x = {"x", true, 0.1, 1000.0, false};
  chart.y = {"y", true, 1.0, 100.0, false};
  chart.series = {point(kOrange, 0.1, 1.0), point(kBlue, 1000.0, 100.0), point(kBluishGreen, 10.0, 10.0),
                  point(kReddishPurple, 1.0, 20.0)};
  const cv::Mat picture = test::drawn(chart);
  expect_at(picture, kBluishGreen, 0.5, 0.5);
  expect_at(picture, kReddishPurple, 0.25, 0.5 * std::log10(20.0));
}

TEST(Chart, PointsBeyondAnAxisLieAtItsEdge) {
  Chart chart = linear_chart();
  chart.series.push_back(point(kBluishGreen, 3.0, 70.0));
  chart.series.push_back(point(kReddishPurple, 6.0, kInfinity));
  chart.series.push_back(point(kSkyBlue, -1e300, 0.0));
  const cv::Mat picture = test::drawn(chart);
  expect_at(picture, kBluishGreen, 0.3, 1.0);
  expect_at(picture, kReddishPurple, 0.6, 1.0);
  expect_at(picture, kSkyBlue, 0.0, 0.5);
}

TEST(Chart, ZeroOnALogarithmicAxisLiesAtItsLowerEnd) {
  Chart chart = linear_chart();
  chart.y = {"y", true, 1.0, 100.0, false};
  chart.series = {point(kOrange, 0.0, 1.0), point(kBlue, 10.0, 100.0), point(kBluishGreen, 5.0, 0.0)};
  expect_at(test::drawn(chart), kBluishGreen, 0.5, 0.0);
}

TEST(Chart, LinesEndWhereTheyLeaveThePlot) {
  Chart chart = linear_chart();
  chart.series.push_back(
      {"", kVermilion, ChartMark::kLine, {0.0, 10.0}, {-5.0, 15.0}, {}});  // leaves at x = 5
  const cv::Mat picture = test::drawn(chart);
  const cv::Rect line = cv::boundingRect(test::mask_of(picture, kVermilion));
  EXPECT_NEAR(line.y, place(picture, 0.5, 1.0).y, 2.0);
  EXPECT_NEAR(line.br().x, place(picture, 0.5, 1.0).x, 3.0);
  EXPECT_TRUE(has_colour_at(picture, kVermilion, place(picture, 0.25, 0.5)));
}

TEST(Chart, LinesBeginWhereTheyEnterThePlot) {
  Chart chart = linear_chart();
  chart.series.push_back(
      {"", kVermilion, ChartMark::kLine, {0.0, 10.0}, {-15.0, 5.0}, {}});  // enters at x = 5
  const cv::Mat picture = test::drawn(chart);
  const cv::Rect line = cv::boundingRect(test::mask_of(picture, kVermilion));
  EXPECT_NEAR(line.br().y, place(picture, 0.5, 0.0).y, 2.0);
  EXPECT_NEAR(line.x, place(picture, 0.5, 0.0).x, 3.0);
}

TEST(Chart, NaNIsAGapInALine) {
  Chart chart = linear_chart();
  const std::vector<double> x = {0, 1, 4, 5, 6, 7, 8, 9};
  chart.series.push_back({"", kVermilion, ChartMark::kLine, x, {2, 2, 2, kNaN, 2, 2, kNaN, 2}, {}});
  const cv::Mat picture = test::drawn(chart);
  for (const double shown : {0.2, 0.39, 0.61, 0.69, 0.9})  // 0.9: alone between gaps
    EXPECT_TRUE(has_colour_at(picture, kVermilion, place(picture, shown, 0.7))) << shown;
  for (const double gap : {0.45, 0.5, 0.55, 0.75, 0.8, 0.85})
    EXPECT_FALSE(has_colour_at(picture, kVermilion, place(picture, gap, 0.7))) << gap;
  EXPECT_LE(cv::boundingRect(test::mask_of(picture, kVermilion)).height, 5) << "nothing runs off to a gap";
}

TEST(Chart, OpenAxesHoldAllNumbers) {
  Chart chart;
  chart.y.is_logarithmic = true;
  chart.series = {point(kOrange, -3.0, 0.02), point(kBlue, 70.0, 900.0)};
  const cv::Mat picture = test::drawn(chart);
  const double right = middle_of(picture, kBlue).x;
  EXPECT_GT(middle_of(picture, kOrange).x, 60.0);
  EXPECT_LT(right, 1140.0);
  EXPECT_NEAR((middle_of(picture, kOrange).y - middle_of(picture, kBlue).y) / std::log10(900.0 / 0.02),
              372.0 / std::log10(1000.0 / 0.02), 1.0)
      << "from 0.02 to 1000, the round numbers about them, on 372 points";
}

TEST(Chart, EqualScalesMakeSquaresSquare) {
  for (const bool ends_are_fixed : {false, true}) {
    Chart chart;
    if (ends_are_fixed) {
      chart.x = {"x", false, 0.0, 4.0, false};
      chart.y = {"y", false, 0.0, 3.0, false};
    }
    chart.y.has_equal_scale = true;
    chart.series = {point(kOrange, 1.0, 1.0), point(kBlue, 3.0, 1.0), point(kBluishGreen, 1.0, 3.0)};
    const cv::Mat picture = test::drawn(chart);
    const cv::Point2d corner = middle_of(picture, kOrange);
    const double right = middle_of(picture, kBlue).x - corner.x;
    EXPECT_GT(right, 200.0);
    EXPECT_NEAR(right, corner.y - middle_of(picture, kBluishGreen).y, 2.0 * kMaxChartError_px);
  }
}

TEST(Chart, UnwritablePlaceIsAnIoError) {
  try {
    write_chart(test::temporary_folder() / "missing" / "chart.png", linear_chart());
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kIo);
  }
}

TEST(Chart, MisuseIsRefused) {
  const auto expect_refused = [](auto spoil) {
    Chart chart = linear_chart();
    spoil(chart);
    EXPECT_THROW(test::drawn(chart), MisuseError);
  };
  expect_refused([](Chart& c) { c.series[0].y.push_back(1.0); });
  expect_refused([](Chart& c) { c.series[0].shade = {0.5, 0.5}; });
  expect_refused([](Chart& c) { c.series[0].shade = {1.01}; });
  expect_refused([](Chart& c) { c.series[0].shade = {kNaN}; });
  expect_refused([](Chart& c) { c.x.low = 10.0; });
  expect_refused([](Chart& c) { c.x.high = kInfinity; });
  expect_refused([](Chart& c) { c.y.high = 1e301; });
  expect_refused([](Chart& c) { c.y.is_logarithmic = true; });  // low is -5
  expect_refused([](Chart& c) { c.levels = {{kNaN, "nowhere"}}; });
  expect_refused([](Chart& c) {
    c.x.has_equal_scale = true;
    c.y = {"y", true, {}, {}, false};
  });
}

}  // namespace
}  // namespace apriltrack
