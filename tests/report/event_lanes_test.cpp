// Lanes of events, read back from the drawing's own elements.
#include "apriltrack/report/event_lanes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "apriltrack/base/check.h"
#include "svg_elements.h"

namespace apriltrack {
namespace {

const std::vector<EventLane> kLanes = {{"seen", SvgInk::kGreenInk},
                                       {"guessed", SvgInk::kOrangeInk},
                                       {"lost", SvgInk::kVermilionInk},
                                       {"never", SvgInk::kPurpleInk}};

struct Bar {
  double left, top, width;
  double right() const { return left + width; }
};

/// The bars of a colour, from left to right.
std::vector<Bar> bars_in(const std::vector<LaneEvent>& events, const std::string& colour) {
  std::vector<Bar> bars;
  for (const test::SvgElement& element : test::svg_elements(event_lanes_svg("lanes", kLanes, events)))
    if (element.name == "rect" && element.style.find("fill:var(--" + colour + ")") != std::string::npos)
      bars.push_back({element.number("x"), element.number("y"), element.number("width")});
  return bars;
}

TEST(EventLanes, BarsLieWhereTheirTimesAre) {
  // Seen from 0 to 5 s, guessed from 5 to 7 s, lost from 7 s to the end, which is a mean interval after 8 s.
  const std::vector<LaneEvent> events = {{0, 0}, {5, 1}, {6, 1}, {7, 2}, {8, 2}};
  const auto seen = bars_in(events, "green"), guessed = bars_in(events, "orange"),
             lost = bars_in(events, "vermilion");
  ASSERT_EQ(seen.size(), 1U);
  ASSERT_EQ(guessed.size(), 1U) << "two that touch are one";
  ASSERT_EQ(lost.size(), 1U);
  const double units_per_s = seen[0].width / 5.0;
  EXPECT_NEAR(guessed[0].width, 2.0 * units_per_s, 0.1);
  EXPECT_NEAR(lost[0].width, 3.0 * units_per_s, 0.1);
  EXPECT_NEAR(guessed[0].left, seen[0].right(), 0.1);
  EXPECT_NEAR(lost[0].left, guessed[0].right(), 0.1);
  EXPECT_GT(guessed[0].top, seen[0].top);
  EXPECT_GT(lost[0].top, guessed[0].top);
  EXPECT_TRUE(bars_in(events, "purple").empty());
}

TEST(EventLanes, OneOfTenThousandIsSeenAndTheDrawingStaysSmall) {
  std::vector<LaneEvent> events;
  for (int i = 0; i < 10'000; ++i) events.push_back({0.01 * i, i == 4321 ? std::size_t{2} : 0});
  const auto seen = bars_in(events, "green"), lost = bars_in(events, "vermilion");
  ASSERT_EQ(lost.size(), 1U);
  EXPECT_GE(lost[0].width, 1.0);
  const double width = seen.back().right() - seen.front().left;
  EXPECT_NEAR(lost[0].left, seen.front().left + 0.4321 * width, 1.5) << "as wide as the narrowest bar";
  for (std::size_t i = 0; i < events.size(); ++i) events[i].lane = i % 4;
  EXPECT_LT(event_lanes_svg("", kLanes, events).element("").size(), 20'000U);
}

TEST(EventLanes, TellsHowManyThereAre) {
  const std::string drawn =
      event_lanes_svg("", kLanes, std::vector<LaneEvent>{{0, 0}, {1, 0}, {2, 2}}).element("");
  EXPECT_THAT(drawn, testing::HasSubstr(">2  (66.7 %)<"));
  EXPECT_THAT(drawn, testing::HasSubstr(">1  (33.3 %)<"));
}

TEST(EventLanes, OneEventAndNoneAreDrawn) {
  EXPECT_EQ(bars_in({{3.0, 1}}, "orange").size(), 1U);
  for (const char* colour : {"green", "orange", "vermilion", "purple"})
    EXPECT_TRUE(bars_in({}, colour).empty());
}

TEST(EventLanes, RefusesWhatItCannotDraw) {
  const auto draw = [](const std::vector<LaneEvent>& events) { return event_lanes_svg("", kLanes, events); };
  EXPECT_THROW(event_lanes_svg("", {}, {}), MisuseError);
  EXPECT_THROW(draw({{0.0, 4}}), MisuseError);
  EXPECT_THROW(draw({{1.0, 0}, {0.5, 0}}), MisuseError);
  EXPECT_THROW(draw({{std::nan(""), 0}}), MisuseError);
}

}  // namespace
}  // namespace apriltrack
