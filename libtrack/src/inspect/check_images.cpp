// What images, their times and their camera file tell.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "apriltrack/camera/rolling_shutter.h"
#include "apriltrack/inspect/recording_summary.h"
#include "apriltrack/source/copied_frames.h"
#include "checks.h"

namespace apriltrack {
namespace {

constexpr double kMuchWhite = 0.25;  ///< Of the pixels of a frame without tags.
constexpr int kDark_level = 40;
/// Of the frames: fewer with a fault are no word on the recording.
constexpr double kManyFrames = 0.1;

bool are_many(std::size_t some, std::size_t all) {
  return static_cast<double>(some) > kManyFrames * static_cast<double>(all);
}

/// White paper that is clipped grows into the black next to it, and nothing tells how far; a lamp or a window
/// that is clipped does no harm.
bool is_overexposed(const FrameFacts& frame) {
  if (frame.tags.empty()) return frame.white_share > kMuchWhite;
  const auto clipped = std::ranges::count_if(frame.tags, &SeenTag::is_clipped);
  return 2 * clipped >= std::ssize(frame.tags);
}

std::string told_sizes(std::span<const ImageSizeCount> sizes) {
  std::vector<std::string> told;
  for (const ImageSizeCount& size : sizes)
    told.push_back(fmt::format("{} of {} x {}", size.frames, size.width, size.height));
  return fmt::format("{}", fmt::join(told, ", "));
}

void check_times(const RecordingFacts& recording, std::vector<RecordingFinding>& findings) {
  if (!recording.tells_times) {
    findings.push_back({FindingSeverity::kNote, "no_times",
                        "the images' names are no times: calibrate and track need --rate HZ, the frames a "
                        "second at which they were taken (1 was taken here)"});
    return;
  }
  const auto copies = static_cast<std::size_t>(std::ranges::count_if(recording.frames, &FrameFacts::is_copy));
  if (copies > 0) {
    const auto first = std::ranges::find_if(recording.frames, &FrameFacts::is_copy);
    findings.push_back({FindingSeverity::kWarning, "copied_frames",
                        message_of_copies(copies, recording.frames.size(), first->name)});
  }
  const FrameTimes times = frame_times(recording.frames);
  if (times.not_forward > 0)
    findings.push_back({FindingSeverity::kWarning, "times_not_forward",
                        fmt::format("{} frames are no later than the frame before: the clock went back, or "
                                    "frames were copied",
                                    times.not_forward)});
  if (times.gaps > 0 && times.rate_hz)
    findings.push_back(
        {FindingSeverity::kNote, "time_gaps",
         fmt::format("{} between frames, the longest {:.2f} s, at {:.3g} frames a second elsewhere: "
                     "calibrate does not mind, track may lose its pose there",
                     times.gaps == 1 ? "1 gap" : fmt::format("{} gaps", times.gaps), times.longest_gap_s,
                     *times.rate_hz)});
}

void check_light(const RecordingFacts& recording, std::vector<RecordingFinding>& findings) {
  std::size_t blank = 0, dark = 0, white = 0;
  for (const FrameFacts& frame : recording.frames) {
    blank += frame.is_blank;
    dark += !frame.is_blank && frame.bright_level < kDark_level;
    white += !frame.is_blank && is_overexposed(frame);
  }
  const std::size_t all = recording.frames.size();
  if (blank > 0)
    findings.push_back(
        {FindingSeverity::kWarning, "blank_frames",
         fmt::format("{} of {} frames are of one brightness all over: was the lens covered?", blank, all)});
  if (are_many(dark, all))
    findings.push_back(
        {FindingSeverity::kWarning, "dark_frames",
         fmt::format("{} of {} frames are dark (99 % of the pixels below grey level {}): more light is "
                     "better than a longer exposure, which blurs",
                     dark, all, kDark_level)});
  if (are_many(white, all))
    findings.push_back(
        {FindingSeverity::kWarning, "white_frames",
         fmt::format(
             "in {} of {} frames the tags' paper is clipped to white, or a quarter of the picture is: "
             "white grows into black there, and corners with it; expose less",
             white, all)});
}

/// Of cameras that were calibrated as such, the centre is a few percent off, and pixels are square to a
/// percent.
void check_intrinsics(const Camera& camera, std::vector<RecordingFinding>& findings) {
  constexpr double kFarFromCentre = 0.12;
  constexpr double kMostUnlike = 0.03;
  const Pinhole& pinhole = camera.model.pinhole();
  if (camera.width > 0 && camera.height > 0) {
    const double off_x = std::abs(pinhole.cx - 0.5 * (camera.width - 1)) / camera.width;
    const double off_y = std::abs(pinhole.cy - 0.5 * (camera.height - 1)) / camera.height;
    if (std::max(off_x, off_y) > kFarFromCentre)
      findings.push_back(
          {FindingSeverity::kWarning, "principal_point",
           fmt::format("camera '{}' has its principal point at ({:.1f}, {:.1f}), {:.0f} % of the width and "
                       "{:.0f} % of the height from the centre of {} x {} pixels: are cx and cy of another "
                       "resolution? Only pictures that were cropped have it so",
                       camera.name, pinhole.cx, pinhole.cy, 100.0 * off_x, 100.0 * off_y, camera.width,
                       camera.height)});
  }
  if (std::abs(pinhole.fx / pinhole.fy - 1.0) > kMostUnlike)
    findings.push_back({FindingSeverity::kWarning, "focal_lengths",
                        fmt::format("camera '{}' has fx / fy = {:.3f}, square pixels have 1: were the images "
                                    "stretched, or fx and fy mistyped?",
                                    camera.name, pinhole.fx / pinhole.fy)});
}

void check_resolution(const Camera& camera, std::span<const ImageSizeCount> sizes,
                      std::vector<RecordingFinding>& findings) {
  if (camera.width == 0 || camera.height == 0 || sizes.empty()) return;
  const ImageSizeCount& most = sizes.front();
  if (most.width == camera.width && most.height == camera.height) return;
  const bool some_fit = std::ranges::any_of(sizes, [&](const ImageSizeCount& size) {
    return size.width == camera.width && size.height == camera.height;
  });
  findings.push_back(
      {some_fit ? FindingSeverity::kWarning : FindingSeverity::kStops, "camera_resolution",
       fmt::format("{} images are {} x {} pixels, but camera '{}' is calibrated for {} x {}{}: {}",
                   some_fit ? "most" : "the", most.width, most.height, camera.name, camera.width,
                   camera.height, some_fit ? ", and calibrate uses no others" : "",
                   advice_on_resolution(camera, most.width, most.height))});
}

void check_exposure(const RecordingFacts& recording, std::vector<RecordingFinding>& findings) {
  const bool is_told = (recording.camera && recording.camera->exposure_s) ||
                       std::ranges::any_of(recording.frames, &FrameFacts::tells_exposure);
  if (is_told) return;
  findings.push_back({FindingSeverity::kNote, "no_exposure",
                      "nothing states the exposure: calibrate needs none, track estimates it from the blur; "
                      "if you know it, write exposure_time (seconds) into the camera file"});
}

}  // namespace

std::vector<RecordingFinding> check_images(const RecordingFacts& recording) {
  std::vector<RecordingFinding> findings;
  const std::vector<ImageSizeCount> sizes = image_sizes(recording.frames);
  if (sizes.size() > 1)
    findings.push_back(
        {FindingSeverity::kWarning, "mixed_resolutions",
         fmt::format("images of {} sizes ({}): a camera file is true of one, and frames of another are left "
                     "out; keep those of one size",
                     sizes.size(), told_sizes(sizes))});
  if (recording.unreadable > 0) {
    // One in twenty is a cable that was touched; more is a fault of the recording.
    const std::size_t all = recording.unreadable + recording.frames.size();
    findings.push_back({20 * recording.unreadable > all ? FindingSeverity::kWarning : FindingSeverity::kNote,
                        "unreadable",
                        fmt::format("{} of {} frames cannot be read; calibrate and track leave them out, too",
                                    recording.unreadable, all)});
  }
  check_times(recording, findings);
  check_light(recording, findings);
  return findings;
}

std::vector<RecordingFinding> check_sizes(const InspectionFacts& facts) {
  std::map<std::string, const RecordingFacts*> first_of_camera;
  for (const RecordingFacts& recording : facts.recordings) {
    if (recording.frames.empty()) continue;
    const RecordingFacts& first =
        *first_of_camera.try_emplace(recording.camera_name, &recording).first->second;
    const ImageSizeCount one = image_sizes(first.frames).front(),
                         other = image_sizes(recording.frames).front();
    if (one.width == other.width && one.height == other.height) continue;
    return {{FindingSeverity::kStops, "camera_sizes",
             fmt::format("{} is of {} x {} pixels and {} of {} x {}, but both are said to be of camera '{}', "
                         "and a camera file is true of one size: name the cameras (cam0=PATH cam1=PATH, with "
                         "a file of the rig), or take one of them at a time",
                         first.input, one.width, one.height, recording.input, other.width, other.height,
                         recording.camera_name)}};
  }
  return {};
}

std::vector<RecordingFinding> check_camera(const RecordingFacts& recording) {
  std::vector<RecordingFinding> findings;
  if (!recording.camera) {
    findings.push_back({FindingSeverity::kNote, "no_camera",
                        "no camera file was given, so that it was not held against the images: calibrate and "
                        "track need --camera"});
    return findings;
  }
  check_resolution(*recording.camera, image_sizes(recording.frames), findings);
  check_intrinsics(*recording.camera, findings);
  if (const auto warning = rolling_shutter_warning(*recording.camera))
    findings.push_back({FindingSeverity::kWarning, "rolling_shutter", *warning});
  check_exposure(recording, findings);
  return findings;
}

std::vector<RecordingFinding> check_blur(const RecordingFacts& recording) {
  constexpr double kMuchBlurred = 0.2;
  std::vector<RecordingFinding> findings;
  const BlurCounts counts = count_blur(recording.frames);
  const auto share = [](std::size_t some, std::size_t all) {
    return all == 0 ? 0.0 : static_cast<double>(some) / static_cast<double>(all);
  };
  if (const double blurred = share(counts.blurred, counts.measured()); blurred > kMuchBlurred)
    findings.push_back({FindingSeverity::kWarning, "blur",
                        fmt::format("in {:.0f} % of the frames the tags are smeared over {:g} px or more (by "
                                    "motion, or out of focus): film more slowly, in more light, or with a "
                                    "shorter exposure",
                                    100.0 * blurred, kBlurredFrom_px)});
  const std::size_t tagged = static_cast<std::size_t>(
      std::ranges::count_if(recording.frames, [](const FrameFacts& frame) { return !frame.tags.empty(); }));
  if (const double unread = share(counts.unread, counts.unread + tagged); unread > kMuchBlurred)
    findings.push_back(
        {FindingSeverity::kWarning, "frames_without_tags",
         fmt::format("no tag can be read in {} frames between frames with tags ({:.0f} %): too blurred, or "
                     "the tags were out of view",
                     counts.unread, 100.0 * unread)});
  return findings;
}

}  // namespace apriltrack
