#include "apriltrack/report/event_lanes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apriltrack/base/check.h"
#include "canvas.h"
#include "chart_axis.h"

namespace apriltrack {
namespace {

// Layout in points.
constexpr double kLanesWidth = 1200.0;
constexpr double kLanesMargin = 60.0;
constexpr double kLanesTop = 66.0;
constexpr double kLaneHeight = 34.0;
constexpr double kLaneAir = 5.0;  // above and below the bars
constexpr double kLanesFoot = 60.0;
constexpr double kLaneLetters = 10.5;
constexpr double kTickLetters = 9.0;
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
    names = std::max(names, Canvas::width_of(lanes[i].name, kLaneLetters));
    numbers = std::max(numbers, Canvas::width_of(number_of(events, i), kLaneLetters));
  }
  constexpr double kGap = 14.0;
  LanesArea area{kLanesMargin + names + kGap,
                 kLanesWidth - kLanesMargin - numbers - kGap,
                 LanesArea::top(lanes.size()),
                 {0.0, 1.0, false}};
  if (!events.empty())
    area.time = {events.front().time_s, events.back().time_s + last_duration(events), false};
  return area;
}

void draw_time_axis(Canvas& canvas, const LanesArea& area) {
  constexpr int kMostLabels = 11;
  for (const Tick& tick : ticks_for(area.time, kMostLabels)) {
    const double x = area.x(tick.value);
    canvas.box({x - 0.5, kLanesTop, 1.0, area.bottom - kLanesTop}, kGrid);
    canvas.text(tick.label, {x, area.bottom + 19.0}, kTickLetters, kPaleInk, Align::kCentre);
  }
  canvas.text("time, s", {0.5 * (area.left + area.right), area.bottom + 42.0}, 10.0, kPaleInk,
              Align::kCentre);
}

void draw_events(Canvas& canvas, const LanesArea& area, std::span<const EventLane> lanes,
                 std::span<const LaneEvent> events) {
  for (std::size_t i = 0; i < events.size(); ++i) {
    const double end_s =
        i + 1 < events.size() ? events[i + 1].time_s : events[i].time_s + last_duration(events);
    const double left = area.x(events[i].time_s);
    const double width = std::max(kNarrowestBar, area.x(end_s) - left);
    canvas.box({left, LanesArea::top(events[i].lane) + kLaneAir, width, kLaneHeight - 2.0 * kLaneAir},
               bgr_of(lanes[events[i].lane].colour));
  }
}

void draw_lanes(Canvas& canvas, const LanesArea& area, std::span<const EventLane> lanes,
                std::span<const LaneEvent> events) {
  for (std::size_t i = 0; i < lanes.size(); ++i) {
    const double base = LanesArea::top(i) + 0.5 * (kLaneHeight + kLaneLetters);
    canvas.text(lanes[i].name, {kLanesMargin, base}, kLaneLetters, kInk);
    canvas.text(number_of(events, i), {kLanesWidth - kLanesMargin, base}, kLaneLetters, kInk, Align::kRight);
    canvas.box({area.left, LanesArea::top(i), area.right - area.left, 1.0}, kGrid);
  }
  canvas.box({area.left, area.bottom, area.right - area.left, 1.0}, kGrid);
}

}  // namespace

std::string event_lanes_png(const std::string& title, std::span<const EventLane> lanes,
                            std::span<const LaneEvent> events) {
  APRILTRACK_CHECK(!lanes.empty(), "there is at least one lane");
  for (std::size_t i = 0; i < events.size(); ++i) {
    APRILTRACK_CHECK(events[i].lane < lanes.size(), "an event's lane is there");
    APRILTRACK_CHECK(std::isfinite(events[i].time_s), "an event's time is finite");
    APRILTRACK_CHECK(i == 0 || events[i - 1].time_s <= events[i].time_s, "events are in the order of time");
  }
  const LanesArea area = area_for(lanes, events);
  Canvas canvas(static_cast<int>(kLanesWidth), static_cast<int>(area.bottom + kLanesFoot));
  canvas.text(Canvas::fitted(title, 16.0, kLanesWidth - 2.0 * kLanesMargin), {kLanesMargin, 42.0}, 16.0,
              kInk);
  draw_time_axis(canvas, area);
  draw_lanes(canvas, area, lanes, events);
  draw_events(canvas, area, lanes, events);
  return canvas.png();
}

}  // namespace apriltrack
