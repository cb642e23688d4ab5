#pragma once

#include "apriltrack/report/colour.h"
#include "apriltrack/tracker/track_result.h"

namespace apriltrack::app {

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

}  // namespace apriltrack::app
