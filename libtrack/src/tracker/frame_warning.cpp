#include "frame_warning.h"

#include <fmt/format.h>

#include "known_exposure.h"

namespace apriltrack {
namespace {

std::string warning_of(const char* whose, std::optional<double> exposure_s) {
  if (!exposure_s || is_exposure(*exposure_s)) return "";
  return fmt::format(
      "the exposure that the {} tells, {:g} s, is neither 0 nor from {:g} to {:g} s: it counts as not told",
      whose, *exposure_s, kMinExposure_s, kMaxExposure_s);
}

}  // namespace

std::string exposure_warning(std::optional<double> of_frame, std::optional<double> of_camera) {
  const bool is_known = of_frame && is_exposure(*of_frame);
  return joined_warnings(warning_of("frame", of_frame), is_known ? "" : warning_of("camera", of_camera));
}

std::string new_recording_warning(Timestamp before, Timestamp time) {
  return fmt::format(
      "the time stamp is {:g} s earlier than that of the frame before: another recording begins, and nothing "
      "is kept of the last",
      seconds_between(time, before));
}

std::string joined_warnings(const std::string& first, const std::string& second) {
  return first.empty() || second.empty() ? first + second : first + "; " + second;
}

}  // namespace apriltrack
