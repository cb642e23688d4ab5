// What the tags' pictures tell of the camera: their outlines of its lens, their edges of its response.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <variant>

#include "apriltrack/base/error.h"
#include "apriltrack/calib/fit_lenses.h"
#include "checks.h"

namespace apriltrack {
namespace {

/// "intrinsics [521, 520, 322, 237], distortion radtan [-0.28, 0.09, 0, 0]".
std::string in_words(const CameraModel& model) {
  const Pinhole& pinhole = model.pinhole();
  const std::vector<double> lens =
      std::visit([](const auto& one) { return one.coefficients(); }, model.distortion());
  return fmt::format(
      "intrinsics [{:.0f}, {:.0f}, {:.0f}, {:.0f}]{}", pinhole.fx, pinhole.fy, pinhole.cx, pinhole.cy,
      lens.empty() ? ""
                   : fmt::format(", distortion {} [{:.2g}]", model.distortion_name(), fmt::join(lens, ", ")));
}

/// nullopt, too, where the pictures are not of the camera's size, of which another finding tells.
std::optional<CameraRig> fitting_rig(const std::vector<FrameDetections>& frames, const Camera& camera) {
  CameraRig rig;
  rig.cameras = {camera};
  try {
    return fit_lenses(frames, rig);
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace

std::vector<RecordingFinding> check_response(const RecordingFacts& recording) {
  const bool has_tags =
      std::ranges::any_of(recording.frames, [](const FrameFacts& frame) { return !frame.tags.empty(); });
  const auto warning = has_tags ? warning_of(recording.response) : std::nullopt;
  if (!warning) return {};
  return {{FindingSeverity::kWarning, "response", *warning}};
}

std::vector<RecordingFinding> check_lens(const RecordingFacts& recording) {
  if (!recording.camera) return {};
  std::vector<FrameDetections> frames;
  for (const FrameFacts& frame : recording.frames) {
    if (!is_usable(frame, recording.camera)) continue;
    const Timestamp number{
        static_cast<std::int64_t>(frames.size())};  // times may be wrong, and do not matter
    frames.push_back({number, recording.camera->name, {}});
    for (const SeenTag& seen : frame.tags)
      frames.back().detections.push_back({seen.tag, seen.corners_px, std::nullopt, std::nullopt});
  }
  const auto better = fitting_rig(frames, *recording.camera);
  if (!better) return {};
  return {
      {FindingSeverity::kWarning, "lens",
       fmt::format("by the lens of camera '{}', {}, the tags do not look square; by about {} they do: is the "
                   "camera file of this camera, zoom and resolution? calibrate refines it with the map, and "
                   "writes what it finds",
                   recording.camera->name, in_words(recording.camera->model),
                   in_words(better->cameras.front().model))}};
}

}  // namespace apriltrack
