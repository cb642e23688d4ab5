#pragma once

#include <array>

#include "apriltrack/report/colour.h"
#include "apriltrack/report/svg_picture.h"
#include "apriltrack/tracker/track_result.h"

namespace apriltrack::app {

/// In the order of kFrameStatuses (apriltrack/eval/run_statistics.h).
inline constexpr std::array<TrackStatus, 5> kTrackStatuses = {TrackStatus::kDetected, TrackStatus::kTracked,
                                                              TrackStatus::kPredicted, TrackStatus::kLost,
                                                              TrackStatus::kUnreadable};

/// The same in every picture and video; told apart by colour-blind eyes too.
inline Colour colour_of(TrackStatus status) {
  switch (status) {
    case TrackStatus::kDetected:
      return kBluishGreen;
    case TrackStatus::kTracked:
      return kSkyBlue;
    case TrackStatus::kPredicted:
      return kOrange;
    case TrackStatus::kLost:
    case TrackStatus::kUnreadable:
      return kVermilion;
  }
  return kVermilion;
}

/// The same on pages, whose colours follow light and dark surroundings.
inline SvgInk ink_of_status(TrackStatus status) {
  switch (status) {
    case TrackStatus::kDetected:
      return SvgInk::kGreenInk;
    case TrackStatus::kTracked:
      return SvgInk::kSkyInk;
    case TrackStatus::kPredicted:
      return SvgInk::kOrangeInk;
    case TrackStatus::kLost:
    case TrackStatus::kUnreadable:
      return SvgInk::kVermilionInk;
  }
  return SvgInk::kVermilionInk;
}

}  // namespace apriltrack::app
