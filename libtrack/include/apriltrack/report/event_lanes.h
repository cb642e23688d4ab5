#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "apriltrack/report/svg_picture.h"

namespace apriltrack {

/// A row of the picture.
struct EventLane {
  std::string name;
  SvgInk ink = SvgInk::kText;
};

/// Something that fell into a lane.
struct LaneEvent {
  double time_s = 0.0;
  std::size_t lane = 0;
};

/// Draws what happened when, such as the status of every frame: a lane for each kind, in it a bar for each
/// event that lasts until the next one, and beside it how many there are. 1010 units wide. A bar has at least
/// the width that can be seen, and bars that touch are one, so that the drawing stays small however many
/// events there are.
///
/// Requires at least one lane; events in the order of time, with finite times and lanes that are there.
SvgPicture event_lanes_svg(const std::string& title, std::span<const EventLane> lanes,
                           std::span<const LaneEvent> events);

}  // namespace apriltrack
