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

}  // namespace apriltrack
