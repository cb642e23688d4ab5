#include "apriltrack/report/detection_timeline.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "apriltrack/base/check.h"
#include "apriltrack/base/error.h"
#include "support/shared_data.h"

namespace apriltrack {
namespace {

// Colours of the legend (Okabe and Ito): blue, green, red order.
const cv::Vec3b kGreenPixel(115, 158, 0);
const cv::Vec3b kOrangePixel(0, 159, 230);
const cv::Vec3b kRedPixel(0, 94, 213);
const cv::Vec3b kInkPixel(117, 106, 98);  // of leaders and of the axis's title

int count_colour(const cv::Mat& picture, const cv::Vec3b& colour, const cv::Rect& area) {
  cv::Mat mask;
  cv::inRange(picture(area), colour, colour, mask);
  return cv::countNonZero(mask);
}

TEST(DetectionTimeline, BarsShowOutcomeInTimeAndBlurInHeight) {
  std::vector<TimelineFrame> frames;
  for (int i = 0; i < 100; ++i) {
    const bool is_early = i < 50;
    frames.push_back(
        {i / 30.0, is_early ? 10.0 : 40.0, is_early ? FrameOutcome::kPoseRight : FrameOutcome::kBlind});
  }
  const auto file = test::temporary_folder() / "timeline.png";
  write_detection_timeline(file, "title", frames, {});
  const cv::Mat picture = cv::imread(file.string());
  ASSERT_EQ(picture.cols, 1200);
  const int chart_bottom = picture.rows - 96;
  const cv::Rect left(70, 0, 500, chart_bottom);
  const cv::Rect right(630, 0, 500, chart_bottom);
  EXPECT_EQ(count_colour(picture, kRedPixel, left), 0);
  EXPECT_EQ(count_colour(picture, kGreenPixel, right), 0);
  const int early = count_colour(picture, kGreenPixel, left);
  const int late = count_colour(picture, kRedPixel, right);
  EXPECT_GT(early, 1000);
  EXPECT_NEAR(static_cast<double>(late) / early, 4.0, 0.4);  // four times the blur, four times the bar
}

TEST(DetectionTimeline, OutlinesLieOnTheCornersOfTheExample) {
  const GrayImage black(320, 240);
  ExampleFrame example{black.view(), {}, "caption", 0.0};
  // A square from (79.5, 59.5) to (239.5, 179.5): pixel centres are whole numbers, so the outline of the
  // picture's middle half; the example is 1080 points wide and starts at (60, 70).
  example.outlines.push_back({{Eigen::Vector2d(79.5, 179.5), {239.5, 179.5}, {239.5, 59.5}, {79.5, 59.5}},
                              FrameOutcome::kPoseWrong});
  const TimelineFrame frame{0.0, 1.0, FrameOutcome::kPoseRight};
  const auto file = test::temporary_folder() / "example.png";
  write_detection_timeline(file, "", {&frame, 1}, {&example, 1});
  const cv::Mat picture = cv::imread(file.string());
  const cv::Rect shown(60, 70, 1080, 810);
  cv::Mat mask;
  cv::inRange(picture(shown), kOrangePixel, kOrangePixel, mask);
  const cv::Rect outline = cv::boundingRect(mask);
  EXPECT_NEAR(outline.x, 270, 2);
  EXPECT_NEAR(outline.y, 202.5, 2);
  EXPECT_NEAR(outline.br().x, 810, 2);
  EXPECT_NEAR(outline.br().y, 607.5, 2);
}

/// Thirty frames of 20 px of blur, the tenth of 5 px, with an example 1080 points wide of each given frame.
cv::Mat with_examples_of(const std::vector<int>& indices) {
  std::vector<TimelineFrame> frames;
  for (int i = 0; i < 30; ++i) frames.push_back({i / 30.0, i == 9 ? 5.0 : 20.0, FrameOutcome::kPoseRight});
  const GrayImage grey(32, 24);
  std::vector<ExampleFrame> examples;
  for (const int i : indices)
    examples.push_back({grey.view(), {}, "", frames[static_cast<std::size_t>(i)].time_s});
  const auto file = test::temporary_folder() / "leaders.png";
  write_detection_timeline(file, "", frames, examples);
  return cv::imread(file.string());
}

constexpr int kPlotLeft = 60, kPlotRight = 1140, kFoot = 96, kPlotHeight = 260;

TEST(DetectionTimeline, AllBarsLieBetweenTheAxisEnds) {
  const cv::Mat picture = with_examples_of({});
  const int bottom = picture.rows - kFoot;
  const cv::Rect chart(0, bottom - kPlotHeight, picture.cols, kPlotHeight);
  cv::Mat mask;
  cv::inRange(picture(chart), kGreenPixel, kGreenPixel, mask);
  const cv::Rect bars = cv::boundingRect(mask);
  EXPECT_NEAR(bars.x, kPlotLeft, 1);
  EXPECT_NEAR(bars.br().x, kPlotRight, 1);
}

TEST(DetectionTimeline, LeadersEndAtTheBarTheyMean) {
  const cv::Mat picture = with_examples_of({9});
  const int bottom = picture.rows - kFoot;
  constexpr double kSlot = (kPlotRight - kPlotLeft) / 30.0;
  const int bar = static_cast<int>(kPlotLeft + 9.5 * kSlot);  // its middle
  const int top = bottom - kPlotHeight / 4;                   // 5 px of 20
  cv::Mat mask;
  cv::inRange(picture, kInkPixel - cv::Vec3b(60, 60, 60), kInkPixel + cv::Vec3b(60, 60, 60), mask);
  for (const int y : {bottom - kPlotHeight + 10, bottom - kPlotHeight / 2, top - 6})
    EXPECT_GT(cv::countNonZero(mask({bar - 2, y, 5, 1})), 0) << y;
  EXPECT_EQ(cv::countNonZero(mask({bar - 2, top + 8, 5, bottom - top - 10})), 0) << "not through the bar";
}

TEST(DetectionTimeline, TheAxisTitleStandsWhereNoLeaderRuns) {
  constexpr int kTitleWidth = 240;
  const auto has_title = [](const cv::Mat& picture, int from_x) {
    const int base = picture.rows - kFoot - kPlotHeight - 10;
    cv::Mat mask;
    const cv::Rect place(from_x, base - 10, kTitleWidth, 10);
    cv::inRange(picture(place), cv::Vec3b(90, 80, 70), cv::Vec3b(150, 140, 130), mask);
    return cv::countNonZero(mask) > 100;
  };
  const cv::Mat far = with_examples_of({20});
  EXPECT_TRUE(has_title(far, kPlotLeft));
  EXPECT_FALSE(has_title(far, kPlotRight - kTitleWidth));
  const cv::Mat near = with_examples_of({1});
  EXPECT_FALSE(has_title(near, kPlotLeft));
  EXPECT_TRUE(has_title(near, kPlotRight - kTitleWidth));
}

TEST(DetectionTimeline, NothingToShowIsMisuse) {
  EXPECT_THROW(write_detection_timeline(test::temporary_folder() / "x.png", "", {}, {}), MisuseError);
}

TEST(DetectionTimeline, AnUnwritablePlaceIsAnIoError) {
  const TimelineFrame frame;
  try {
    write_detection_timeline(test::temporary_folder() / "missing" / "x.png", "", {&frame, 1}, {});
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kIo);
  }
}

}  // namespace
}  // namespace apriltrack
