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
const cv::Vec3b kRedPixel(0, 70, 213);

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
