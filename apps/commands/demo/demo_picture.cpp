#include "demo_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apriltrack/camera/camera.h"
#include "apriltrack/eval/evaluate_trajectory.h"
#include "apriltrack/eval/trajectory.h"
#include "apriltrack/report/detection_timeline.h"
#include "apriltrack/source/image_file.h"
#include "apriltrack/source/sequence_writer.h"
#include "apriltrack/tags/tag_map.h"

namespace apriltrack::app {
namespace {
namespace fs = std::filesystem;

constexpr double kRightBelow_px = 5.0;
constexpr double kExampleBlurs_px[] = {1.0, 8.0, 40.0};  // sharp; where detection begins to fail; far beyond

FrameOutcome outcome_of(const FrameScore& frame) {
  if (!frame.corner_error_px) return FrameOutcome::kBlind;
  return *frame.corner_error_px < kRightBelow_px ? FrameOutcome::kPoseRight : FrameOutcome::kPoseWrong;
}

BlindnessFigures count(const std::vector<FrameScore>& frames) {
  BlindnessFigures figures;
  for (const FrameScore& frame : frames) {
    ++figures.frames;
    const FrameOutcome outcome = outcome_of(frame);
    figures.right += outcome == FrameOutcome::kPoseRight;
    figures.wrong += outcome == FrameOutcome::kPoseWrong;
    figures.blind += outcome == FrameOutcome::kBlind;
  }
  return figures;
}

std::vector<TimelineFrame> time_line(const std::vector<FrameScore>& frames) {
  std::vector<TimelineFrame> line;
  for (const FrameScore& frame : frames) {
    line.push_back(
        {seconds_between(frames.front().timestamp, frame.timestamp), frame.blur_px, outcome_of(frame)});
  }
  return line;
}

const FrameScore& nearest_in_blur(const std::vector<FrameScore>& frames, double blur_px) {
  return *std::min_element(frames.begin(), frames.end(), [&](const FrameScore& a, const FrameScore& b) {
    return std::abs(a.blur_px - blur_px) < std::abs(b.blur_px - blur_px);
  });
}

Pose true_pose(const Trajectory& truth, Timestamp time) {
  return std::find_if(truth.begin(), truth.end(), [&](const TimedPose& p) { return p.timestamp == time; })
      ->pose;
}

ExampleFrame example(const FrameScore& frame, const Pose& T_camera_map, const CornerScene& scene,
                     const GrayImage& image, double time_s) {
  ExampleFrame shown{image.view(), {}, {}, time_s};
  for (const VisibleTag& tag : visible_tags(scene, T_camera_map)) {
    TagOutline outline;
    outline.outcome = outcome_of(frame);
    for (std::size_t i = 0; i < tag.corners_map.size(); ++i)
      outline.corners_px[i] = project_continued(scene.camera.model, T_camera_map * tag.corners_map[i]);
    shown.outlines.push_back(outline);
  }
  shown.caption = fmt::format(
      "blur {:.0f} px: {}", frame.blur_px,
      frame.corner_error_px ? fmt::format("pose {:.2f} px off", *frame.corner_error_px) : "blind");
  return shown;
}

}  // namespace

BlindnessFigures draw_blindness_picture(const fs::path& sequence, const fs::path& estimate,
                                        const fs::path& picture) {
  const Trajectory truth = read_tum(sequence / "truth.tum");
  const CornerScene scene{read_cameras(sequence / "camera.yaml").cameras.front(),
                          read_tag_map(sequence / "map.yaml")};
  const std::vector<FrameScore> frames = evaluate_trajectory(truth, read_tum(estimate), &scene, {}).frames;

  std::vector<FrameScore> chosen;
  for (const double blur_px : kExampleBlurs_px) chosen.push_back(nearest_in_blur(frames, blur_px));
  std::sort(chosen.begin(), chosen.end(),
            [](const FrameScore& a, const FrameScore& b) { return a.timestamp < b.timestamp; });
  std::vector<GrayImage> images;
  std::vector<ExampleFrame> examples;
  images.reserve(chosen.size());  // the examples hold views
  for (const FrameScore& frame : chosen) {
    images.push_back(read_image(sequence / "frames" / sequence_frame_name(frame.timestamp)));
    examples.push_back(example(frame, true_pose(truth, frame.timestamp).inverse(), scene, images.back(),
                               seconds_between(frames.front().timestamp, frame.timestamp)));
  }
  write_detection_timeline(picture, "Where detection goes blind: multi-tag PnP in a blurred recording",
                           time_line(frames), examples);
  return count(frames);
}

}  // namespace apriltrack::app
