#include "apriltrack/report/event_lanes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "apriltrack/base/check.h"
#include "chart_axis.h"
#include "svg_inks.h"

namespace apriltrack {
namespace {

// Layout in units of the drawing.
constexpr double kLanesWidth = 1010.0;
constexpr double kLanesSide = 12.0;
constexpr double kLanesTop = 44.0;
constexpr double kLaneHeight = 27.0;
constexpr double kLaneAir = 4.0;  // above and below the bars
constexpr double kLanesFoot = 44.0;
constexpr double kLaneLetters = 13.0;
constexpr double kNarrowestBar = 1.5;

/// Names stand before the bars, numbers behind them.
struct LanesArea {
  double left, right, bottom;
  AxisRange time;

  double x(double time_s) const { return left + time.fraction(time_s) * (right - left); }
  static double top(std::size_t lane) { return kLanesTop + static_cast<double>(lane) * kLaneHeight; }
};

std::size_t count_events(std::span<const LaneEvent> events, std::size_t lane) {
  return static_cast<std::size_t>(
      std::ranges::count_if(events, [&](const LaneEvent& event) { return event.lane == lane; }));
}

std::string number_of(std::span<const LaneEvent> events, std::size_t lane) {
  const std::size_t count = count_events(events, lane);
  if (count == 0) return "0";
  return fmt::format("{}  ({:.1f} %)", count,
                     100.0 * static_cast<double>(count) / static_cast<double>(events.size()));
}

/// Of the last event nobody knows how long it lasts: as long as they do on the whole.
double last_duration(std::span<const LaneEvent> events) {
  if (events.size() < 2) return 1.0;
  const double duration_s = events.back().time_s - events.front().time_s;
  return std::max(1e-6, duration_s / static_cast<double>(events.size() - 1));
}

LanesArea area_for(std::span<const EventLane> lanes, std::span<const LaneEvent> events) {
  double names = 0.0, numbers = 0.0;
  for (std::size_t i = 0; i < lanes.size(); ++i) {
    names = std::max(names, svg_width_of(lanes[i].name, kLaneLetters));
    numbers = std::max(numbers, svg_width_of(number_of(events, i), kLaneLetters));
  }
  constexpr double kGap = 12.0;
  LanesArea area{kLanesSide + names + kGap,
                 kLanesWidth - kLanesSide - numbers - kGap,
                 LanesArea::top(lanes.size()),
                 {0.0, 1.0, false}};
  if (!events.empty())
    area.time = {events.front().time_s, events.back().time_s + last_duration(events), false};
  return area;
}

void draw_time_axis(const LanesArea& area, SvgPicture& picture) {
  constexpr int kMostLabels = 11;
  for (const Tick& tick : ticks_for(area.time, kMostLabels)) {
    const double x = area.x(tick.value);
    picture.line({x, kLanesTop}, {x, area.bottom}, {.stroke = SvgInk::kRule});
    picture.text({x, area.bottom + 16.0}, tick.label, {.ink = SvgInk::kPale, .anchor = SvgAnchor::kMiddle});
  }
  picture.text({0.5 * (area.left + area.right), area.bottom + 36.0}, "time, s",
               {.size = kLaneLetters, .ink = SvgInk::kPale, .anchor = SvgAnchor::kMiddle});
}

/// From left to right; of one lane.
struct LaneBar {
  double left, right;
};

std::vector<LaneBar> bars_of(const LanesArea& area, std::size_t lane, std::span<const LaneEvent> events) {
  std::vector<LaneBar> bars;
  for (std::size_t i = 0; i < events.size(); ++i) {
    if (events[i].lane != lane) continue;
    const double end_s =
        i + 1 < events.size() ? events[i + 1].time_s : events[i].time_s + last_duration(events);
    const double left = area.x(events[i].time_s);
    const double right = std::max(left + kNarrowestBar, area.x(end_s));
    if (!bars.empty() && left <= bars.back().right) {
      bars.back().right = std::max(right, bars.back().right);
    } else {
      bars.push_back({left, right});
    }
  }
  return bars;
}

void draw_lane(const LanesArea& area, const EventLane& lane, std::size_t i, std::span<const LaneEvent> events,
               SvgPicture& picture) {
  const double top = LanesArea::top(i), base = top + 0.5 * kLaneHeight + 0.35 * kLaneLetters;
  picture.text({kLanesSide, base}, lane.name, {.size = kLaneLetters});
  picture.text({kLanesWidth - kLanesSide, base}, number_of(events, i),
               {.size = kLaneLetters, .anchor = SvgAnchor::kEnd});
  picture.line({area.left, top}, {area.right, top}, {.stroke = SvgInk::kRule});
  for (const LaneBar& bar : bars_of(area, i, events))
    picture.rectangle({bar.left, top + kLaneAir}, {bar.right - bar.left, kLaneHeight - 2.0 * kLaneAir},
                      {.stroke = SvgInk::kNone, .fill = lane.ink});
}

}  // namespace

SvgPicture event_lanes_svg(const std::string& title, std::span<const EventLane> lanes,
                           std::span<const LaneEvent> events) {
  APRILTRACK_CHECK(!lanes.empty(), "there is at least one lane");
  for (std::size_t i = 0; i < events.size(); ++i) {
    APRILTRACK_CHECK(events[i].lane < lanes.size(), "an event's lane is there");
    APRILTRACK_CHECK(std::isfinite(events[i].time_s), "an event's time is finite");
    APRILTRACK_CHECK(i == 0 || events[i - 1].time_s <= events[i].time_s, "events are in the order of time");
  }
  const LanesArea area = area_for(lanes, events);
  SvgPicture picture(kLanesWidth, area.bottom + kLanesFoot);
  picture.text({kLanesSide, 26.0}, title, {.size = 16.0, .is_bold = true});
  draw_time_axis(area, picture);
  for (std::size_t i = 0; i < lanes.size(); ++i) draw_lane(area, lanes[i], i, events, picture);
  picture.line({area.left, area.bottom}, {area.right, area.bottom}, {.stroke = SvgInk::kRule});
  return picture;
}

}  // namespace apriltrack
