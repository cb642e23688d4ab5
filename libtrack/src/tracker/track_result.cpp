#include "apriltrack/tracker/track_result.h"

#include "apriltrack/base/check.h"

namespace apriltrack {

std::string to_string(TrackStatus status) {
  switch (status) {
    case TrackStatus::kDetected:
      return "detected";
    case TrackStatus::kTracked:
      return "tracked";
    case TrackStatus::kPredicted:
      return "predicted";
    case TrackStatus::kLost:
      return "lost";
    case TrackStatus::kUnreadable:
      return "unreadable";
  }
  APRILTRACK_CHECK(false, "not a TrackStatus");
  return {};
}

std::string to_string(TagState state) {
  switch (state) {
    case TagState::kUsed:
      return "used";
    case TagState::kOccluded:
      return "occluded";
    case TagState::kHidden:
      return "hidden";
    case TagState::kElsewhere:
      return "elsewhere";
    case TagState::kSuspect:
      return "suspect";
  }
  APRILTRACK_CHECK(false, "not a TagState");
  return {};
}

}  // namespace apriltrack
