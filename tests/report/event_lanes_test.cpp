// Lanes of events, read back as a picture.
#include "apriltrack/report/event_lanes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "apriltrack/base/check.h"
#include "picture_marks.h"

namespace apriltrack {
namespace {

const std::vector<EventLane> kLanes = {
    {"seen", kBluishGreen}, {"guessed", kOrange}, {"lost", kVermilion}, {"never", kReddishPurple}};

cv::Mat lanes_picture(const std::vector<LaneEvent>& events) {
  const std::string png = event_lanes_png("lanes", kLanes, events);
  return cv::imdecode(std::vector<unsigned char>(png.begin(), png.end()), cv::IMREAD_COLOR);
}

/// Left, right, top and bottom of all pixels of a colour.
cv::Rect extent_of(const cv::Mat& picture, const Colour& colour, int tolerance = 24) {
  std::vector<cv::Point> at;
  cv::findNonZero(test::mask_of(picture, colour, tolerance), at);
  return at.empty() ? cv::Rect() : cv::boundingRect(at);
}

TEST(EventLanes, BarsLieWhereTheirTimesAre) {
  // Seen from 0 to 5 s, guessed from 5 to 7 s, lost from 7 s to the end, which is a mean interval after 8 s.
  const cv::Mat picture = lanes_picture({{0, 0}, {5, 1}, {6, 1}, {7, 2}, {8, 2}});
  const cv::Rect seen = extent_of(picture, kBluishGreen), guessed = extent_of(picture, kOrange),
                 lost = extent_of(picture, kVermilion);
  const double px_per_s = seen.width / 5.0;
  EXPECT_NEAR(guessed.width, 2.0 * px_per_s, 2.0);
  EXPECT_NEAR(lost.width, 3.0 * px_per_s, 2.0);
  EXPECT_NEAR(guessed.x, seen.br().x, 2.0);
  EXPECT_NEAR(lost.x, guessed.br().x, 2.0);
  EXPECT_GT(guessed.y, seen.br().y);
  EXPECT_GT(lost.y, guessed.br().y);
  EXPECT_FALSE(test::shows(picture, kReddishPurple));
}

TEST(EventLanes, OneOfTenThousandIsSeen) {
  std::vector<LaneEvent> events;
  for (int i = 0; i < 10'000; ++i) events.push_back({0.01 * i, i == 4321 ? std::size_t{2} : 0});
  const cv::Mat picture = lanes_picture(events);
  const cv::Rect seen = extent_of(picture, kBluishGreen);
  // The bar is about a pixel wide, and half of its colour may lie in the next one.
  const cv::Rect lost = extent_of(picture, kVermilion, 90);
  ASSERT_GE(lost.width, 1);
  EXPECT_NEAR(lost.x + 0.5 * lost.width, seen.x + 0.4321 * seen.width, 2.5);
}

TEST(EventLanes, OneEventAndNoneAreDrawn) {
  EXPECT_TRUE(test::shows(lanes_picture({{3.0, 1}}), kOrange));
  const cv::Mat none = lanes_picture({});
  for (const EventLane& lane : kLanes) EXPECT_FALSE(test::shows(none, lane.colour)) << lane.name;
}

TEST(EventLanes, RefusesWhatItCannotDraw) {
  EXPECT_THROW(event_lanes_png("", {}, {}), MisuseError);
  EXPECT_THROW(lanes_picture({{0.0, 4}}), MisuseError);
  EXPECT_THROW(lanes_picture({{1.0, 0}, {0.5, 0}}), MisuseError);
  EXPECT_THROW(lanes_picture({{std::nan(""), 0}}), MisuseError);
}

}  // namespace
}  // namespace apriltrack
