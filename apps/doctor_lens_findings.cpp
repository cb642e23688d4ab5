// What the tags' outlines tell of the lens.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <variant>

#include "apriltrack/calib/fit_lenses.h"
#include "doctor_findings.h"

namespace apriltrack::app {
namespace {

struct Coefficients {
  std::vector<double> operator()(const NoDistortion&) const { return {}; }
  template <typename Lens>
  std::vector<double> operator()(const Lens& lens) const {
    return lens.coefficients();
  }
};

/// "[521, 520, 322, 237] with [-0.28, 0.09, 0, 0]".
std::string in_words(const CameraModel& model) {
  const Pinhole& pinhole = model.pinhole();
  const std::vector<double> lens = std::visit(Coefficients{}, model.distortion());
  return fmt::format("intrinsics [{:.0f}, {:.0f}, {:.0f}, {:.0f}]{}", pinhole.fx, pinhole.fy, pinhole.cx,
                     pinhole.cy,
                     lens.empty() ? "" : fmt::format(", distortion [{:.2g}]", fmt::join(lens, ", ")));
}

}  // namespace

std::vector<Finding> find_in_lens(const RecordingFacts& recording) {
  if (!recording.camera) return {};
  std::vector<FrameDetections> frames;
  for (const FrameFacts& frame : recording.frames) {
    frames.push_back({frame.time, recording.camera->name, {}});
    for (const SeenTag& seen : frame.tags)
      frames.back().detections.push_back({seen.tag, seen.corners_px, std::nullopt, std::nullopt});
  }
  CameraRig rig;
  rig.cameras = {*recording.camera};
  const auto better = fit_lenses(frames, rig);
  if (!better) return {};
  return {
      {Severity::kWarning, "lens",
       fmt::format("by the lens of camera '{}', {}, the tags do not look square; by about {} they do: is the "
                   "camera file of this camera, zoom and resolution? calibrate refines it with the map, and "
                   "writes what it finds",
                   recording.camera->name, in_words(recording.camera->model),
                   in_words(better->cameras.front().model))}};
}

}  // namespace apriltrack::app
