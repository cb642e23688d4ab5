// Charts as drawings: two points in the corners of the axes tell where the plot lies, and what is between
// must lie where the linear or logarithmic map says.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apriltrack/base/check.h"
#include "apriltrack/report/chart.h"
#include "svg_elements.h"

namespace apriltrack {
namespace {

using test::SvgElement;
using testing::HasSubstr;

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

ChartSeries dot(Colour colour, double x, double y) {
  return {"", colour, ChartMark::kPoints, {x}, {y}, {}, {}, 1.0};
}

/// An orange and a blue point in the corners.
Chart chart_between(double low_x, double high_x, double low_y, double high_y, bool is_logarithmic) {
  Chart chart;
  chart.title = "a < b";
  chart.x = {"time, s", false, low_x, high_x, false};
  chart.y = {"error, px", is_logarithmic, low_y, high_y, false};
  chart.series = {dot(kOrange, low_x, low_y), dot(kBlue, high_x, high_y)};
  return chart;
}

std::vector<SvgElement> drawn_in(const SvgPicture& picture, const std::string& element,
                                 const std::string& colour) {
  std::vector<SvgElement> found;
  for (const SvgElement& one : test::svg_elements(picture))
    if (one.name == element && one.style.find("var(--" + colour + ")") != std::string::npos)
      found.push_back(one);
  return found;
}

std::vector<Eigen::Vector2d> dots_in(const SvgPicture& picture, const std::string& colour) {
  std::vector<Eigen::Vector2d> all;
  for (const SvgElement& one : drawn_in(picture, "path", colour))
    for (const Eigen::Vector2d& point : one.points("d")) all.push_back(point);
  return all;
}

/// Of the plot, from its lower left corner, as a share of its size.
Eigen::Vector2d share_of_plot(const SvgPicture& picture, const Eigen::Vector2d& point) {
  const Eigen::Vector2d low = dots_in(picture, "orange").at(0), high = dots_in(picture, "blue").at(0);
  return (point - low).cwiseQuotient(high - low);
}

TEST(ChartSvg, PointsLieWhereALinearMapPutsThem) {
  Chart chart = chart_between(0.0, 10.0, -5.0, 5.0, false);
  chart.series.push_back(dot(kBluishGreen, 2.5, 2.0));
  const SvgPicture picture = chart_svg(chart);
  const auto green = dots_in(picture, "green");
  ASSERT_EQ(green.size(), 1U);
  EXPECT_LT((share_of_plot(picture, green[0]) - Eigen::Vector2d(0.25, 0.7)).norm(), 1e-3);
  EXPECT_LT(dots_in(picture, "blue").at(0).y(), dots_in(picture, "orange").at(0).y()) << "up is up";
}

TEST(ChartSvg, PointsLieWhereALogarithmicMapPutsThem) {
  Chart chart = chart_between(0.0, 1.0, 0.01, 1000.0, true);
  chart.series.push_back(dot(kVermilion, 0.5, 3.0));
  const SvgPicture picture = chart_svg(chart);
  const Eigen::Vector2d share = share_of_plot(picture, dots_in(picture, "vermilion").at(0));
  EXPECT_NEAR(share.y(), std::log10(3.0 / 0.01) / 5.0, 1e-3);
}

TEST(ChartSvg, PointsBeyondTheAxesAreHeldAtTheirEnds) {
  Chart chart = chart_between(0.0, 10.0, 0.0, 1.0, false);
  chart.series.push_back(dot(kBluishGreen, 5.0, 7.0));
  const SvgPicture picture = chart_svg(chart);
  EXPECT_NEAR(share_of_plot(picture, dots_in(picture, "green").at(0)).y(), 1.0, 1e-3);
}

TEST(ChartSvg, LinesEndAtGapsAndAtTheEdgeOfThePlot) {
  Chart chart = chart_between(0.0, 10.0, 0.0, 1.0, false);
  // Two pieces; the second leaves the plot at x = 7.5 and comes back at 9.
  chart.series.push_back({"line",
                          kReddishPurple,
                          ChartMark::kLine,
                          {0.0, 2.0, 3.0, 5.0, 7.0, 8.0, 10.0},
                          {0.1, 0.2, kNoNumber, 0.5, 0.5, 1.5, 0.5},
                          {},
                          {},
                          1.0});
  const SvgPicture picture = chart_svg(chart);
  std::vector<std::vector<Eigen::Vector2d>> lines;
  for (const SvgElement& one : drawn_in(picture, "polyline", "purple")) {
    lines.emplace_back();
    for (const Eigen::Vector2d& point : one.points("points"))
      lines.back().push_back(share_of_plot(picture, point));
  }
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_LT((lines[0].back() - Eigen::Vector2d(0.2, 0.2)).norm(), 1e-3);
  EXPECT_LT((lines[1].front() - Eigen::Vector2d(0.5, 0.5)).norm(), 1e-3);
  EXPECT_LT((lines[1].back() - Eigen::Vector2d(0.75, 1.0)).norm(), 1e-3);
  EXPECT_LT((lines[2].front() - Eigen::Vector2d(0.9, 1.0)).norm(), 1e-3);
}

TEST(ChartSvg, BandsAreAsWideAsTheySay) {
  Chart chart = chart_between(0.0, 10.0, 0.0, 1.0, false);
  ChartSeries band{"", kBluishGreen, ChartMark::kLine, {2.0, 8.0}, {0.5, 0.5}, {}, {0.1, 0.3}, 1.0};
  chart.series.push_back(band);
  const SvgPicture picture = chart_svg(chart);
  const auto polygons = drawn_in(picture, "polygon", "green");
  ASSERT_EQ(polygons.size(), 1U);
  const auto corners = polygons[0].points("points");
  ASSERT_EQ(corners.size(), 4U);
  const Eigen::Vector2d expected[] = {{0.2, 0.6}, {0.8, 0.8}, {0.8, 0.2}, {0.2, 0.4}};
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_LT((share_of_plot(picture, corners[i]) - expected[i]).norm(), 1e-3) << i;
}

TEST(ChartSvg, ManyNumbersKeepTheirPeaksAndTheDrawingStaysSmall) {
  Chart chart = chart_between(0.0, 100.0, 0.0, 1.0, false);
  ChartSeries noise{"noise", kBluishGreen, ChartMark::kLineAndPoints, {}, {}, {}, {}, 1.0};
  for (int i = 0; i < 200'000; ++i) {
    noise.x.push_back(100.0 * i / 200'000.0);
    noise.y.push_back(i == 123'456 ? 0.9 : 0.2 + 1e-3 * ((i * 7919) % 101));
  }
  chart.series.push_back(noise);
  const SvgPicture picture = chart_svg(chart);
  EXPECT_LT(picture.element("").size(), 600'000U);
  double highest = 0.0, at = 0.0;
  for (const SvgElement& one : drawn_in(picture, "polyline", "green")) {
    for (const Eigen::Vector2d& point : one.points("points")) {
      const Eigen::Vector2d share = share_of_plot(picture, point);
      if (share.y() <= highest) continue;
      highest = share.y();
      at = share.x();
    }
  }
  EXPECT_NEAR(highest, 0.9, 1e-3);
  EXPECT_NEAR(at, 0.61728, 1e-3);
}

TEST(ChartSvg, NamesTitleAxesSeriesAndLevels) {
  Chart chart = chart_between(0.0, 10.0, 0.1, 10.0, true);
  chart.series.push_back({"green", kBluishGreen, ChartMark::kRings, {1.0}, {1.0}, {}, {}, 1.0});
  chart.series.push_back({"empty", kVermilion, ChartMark::kCrosses, {1.0}, {kNoNumber}, {}, {}, 1.0});
  chart.levels = {{5.0, "5 px"}};
  const std::string drawn = chart_svg(chart).element("");
  for (const char* words :
       {">a &lt; b<", ">time, s<", ">error, px<", ">green<", ">empty (none)<", ">5 px<", ">0.1<"})
    EXPECT_THAT(drawn, HasSubstr(words));
}

TEST(ChartSvg, RefusesWhatItCannotDraw) {
  Chart chart = chart_between(0.0, 10.0, 0.0, 1.0, false);
  chart.series.push_back(dot(Colour{1, 2, 3}, 1.0, 0.5));
  EXPECT_THROW(chart_svg(chart), MisuseError);
  chart.series.back() = dot(kBlue, 1.0, 0.5);
  chart.series.back().shade = {0.5};
  EXPECT_THROW(chart_svg(chart), MisuseError);
}

}  // namespace
}  // namespace apriltrack
