#include "apriltrack/detect/picture_size.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "apriltrack/base/error.h"
#include "mixed_pictures.h"
#include "picture_scales.h"

namespace apriltrack {
namespace {

constexpr double kBeyondBorder =
    0.05;  ///< Of width and height: where detectors put corners that are cut off.
constexpr double kStrayFrames = 0.05;

/// All corners of a frame lie in it.
struct CornerBox {
  Eigen::Vector2d least = Eigen::Vector2d::Constant(HUGE_VAL);
  Eigen::Vector2d most = Eigen::Vector2d::Constant(-HUGE_VAL);

  void add(const CornerBox& other) {
    least = least.cwiseMin(other.least);
    most = most.cwiseMax(other.most);
  }
};

struct OutsideCorner {
  const FrameDetections* frame = nullptr;
  const Detection* detection = nullptr;
  std::size_t corner = 0;
};

/// What was seen by one camera.
struct Sights {
  std::vector<CornerBox> boxes;  ///< One a frame with tags.
  std::size_t num_outside = 0;   ///< Of them.
  std::optional<OutsideCorner> first;
};

bool is_outside(const Eigen::Vector2d& pixel, const Camera& camera) {
  const Eigen::Vector2d size(camera.width, camera.height);
  const Eigen::Vector2d past = kBeyondBorder * size;
  return !((pixel + past).minCoeff() >= -0.5 && (size + past - pixel).minCoeff() >= 0.5);
}

Sights corners_of(std::span<const FrameDetections> frames, const Camera& camera) {
  Sights sights;
  for (const FrameDetections& frame : frames) {
    if (frame.camera != camera.name || frame.detections.empty()) continue;
    CornerBox box;
    bool has_outside = false;
    for (const Detection& detection : frame.detections) {
      for (std::size_t k = 0; k < kNumCorners; ++k) {
        const Eigen::Vector2d& corner = detection.corners_px[k];
        if (!corner.allFinite()) continue;  // told of elsewhere
        box.add({corner, corner});
        if (!is_outside(corner, camera)) continue;
        has_outside = true;
        if (!sights.first) sights.first = OutsideCorner{&frame, &detection, k};
      }
    }
    if (has_outside) ++sights.num_outside;
    sights.boxes.push_back(box);
  }
  return sights;
}

/// The lowest right corner of the picture that was seen; of 50 frames one may be a stray.
Eigen::Vector2d reach(const std::vector<CornerBox>& boxes) {
  const auto nearly_most = [&](int axis) {
    std::vector<double> values;
    for (const CornerBox& box : boxes) values.push_back(box.most[axis]);
    std::ranges::sort(values);
    return values[static_cast<std::size_t>(std::floor(0.98 * static_cast<double>(values.size() - 1)))];
  };
  return {nearly_most(0), nearly_most(1)};
}

/// The camera's resolution times `scale`; nothing where that is no whole number.
std::optional<Eigen::Vector2i> scaled_size(const Camera& camera, double scale) {
  const Eigen::Vector2d size = scale * Eigen::Vector2d(camera.width, camera.height);
  const Eigen::Vector2i whole = size.array().round().matrix().cast<int>();
  if ((whole.cast<double>() - size).cwiseAbs().maxCoeff() > 1e-6) return std::nullopt;
  return whole;
}

std::string advice_on_larger(const Camera& camera, const Eigen::Vector2d& reach_px) {
  for (const double scale : kPictureScales) {
    const auto size = scaled_size(camera, scale);
    if (!size) continue;
    const Eigen::Vector2d share = reach_px.cwiseQuotient(size->cast<double>());
    if (share.maxCoeff() > 1.0 + 0.5 * kBeyondBorder) continue;
    constexpr double kLeastFilled = 0.7, kLeastFilledOfBoth = 0.5;
    if (share.maxCoeff() < kLeastFilled || share.minCoeff() < kLeastFilledOfBoth) break;
    return fmt::format("They fit pictures of {} x {}: {}", size->x(), size->y(),
                       advice_on_resolution(camera, size->x(), size->y()));
  }
  return "Give the camera file of the pictures' resolution";
}

/// Short, whatever a damaged file has.
std::string pixels(double px) {
  constexpr double kOfAnyPicture = 1e6;
  return std::abs(px) < kOfAnyPicture ? fmt::format("{:.1f}", px) : fmt::format("{:.3g}", px);
}

std::string outside_corner(const Camera& camera, const Sights& sights, const DetectionPlace& place) {
  const OutsideCorner& first = *sights.first;
  const Eigen::Vector2d& corner = first.detection->corners_px[first.corner];
  return fmt::format("{}corner {} of {} lies at ({}, {}), and camera '{}' is calibrated for {} x {} pixels",
                     place ? "" : fmt::format("at {} ns ", first.frame->timestamp.ns), first.corner,
                     to_string(first.detection->tag), pixels(corner.x()), pixels(corner.y()), camera.name,
                     camera.width, camera.height);
}

void refuse_pictures(const Camera& camera, const Sights& sights, const DetectionPlace& place) {
  const Eigen::Vector2d reach_px = reach(sights.boxes);
  throw invalid_input(
      place ? place(*sights.first->frame, *sights.first->detection) : "detections",
      fmt::format("{}; {} of {} frames have corners outside, and they reach to ({:.0f}, {:.0f}): they are of "
                  "another camera, or of pictures of another size. {}",
                  outside_corner(camera, sights, place), sights.num_outside, sights.boxes.size(),
                  reach_px.x(), reach_px.y(), advice_on_larger(camera, reach_px)));
}

/// Corners of many frames that fill a smaller picture of the same shape to all four sides, and nothing else.
std::optional<std::string> smaller_picture(const Camera& camera, const std::vector<CornerBox>& boxes) {
  constexpr std::size_t kManyFrames = 20;
  constexpr double kNearSide = 0.1;
  if (boxes.size() < kManyFrames) return std::nullopt;
  CornerBox all;
  for (const CornerBox& box : boxes) all.add(box);
  for (const double scale : kPictureScales) {
    const auto size = scaled_size(camera, 1.0 / scale);
    if (!size) continue;
    const Eigen::Vector2d sides = size->cast<double>();
    const bool fits = (all.most.cwiseQuotient(sides)).maxCoeff() < 1.0 + 0.2 * kBeyondBorder;
    const bool fills = (all.most.cwiseQuotient(sides)).minCoeff() > 1.0 - kNearSide &&
                       (all.least.cwiseQuotient(sides)).maxCoeff() < kNearSide;
    if (!fits || !fills) continue;
    return fmt::format(
        "all corners of camera '{}' lie in ({:.0f} to {:.0f}, {:.0f} to {:.0f}), as in pictures of {} x {} "
        "pixels, but it is calibrated for {} x {}: {}",
        camera.name, all.least.x(), all.most.x(), all.least.y(), all.most.y(), size->x(), size->y(),
        camera.width, camera.height, advice_on_resolution(camera, size->x(), size->y()));
  }
  return std::nullopt;
}

}  // namespace

std::vector<std::string> check_picture_sizes(std::span<const FrameDetections> frames, const CameraRig& rig,
                                             const DetectionPlace& place) {
  std::vector<std::string> warnings;
  for (const Camera& camera : rig.cameras) {
    if (camera.width <= 0 || camera.height <= 0) continue;
    if (const auto change = change_of_picture_size(frames, camera)) {
      const FrameDetections& after = *change->first_after;
      throw invalid_input(place ? place(after, after.detections.front()) : "detections", change->words);
    }
    const Sights sights = corners_of(frames, camera);
    if (!sights.first) {
      if (auto warning = smaller_picture(camera, sights.boxes)) warnings.push_back(std::move(*warning));
      continue;
    }
    const auto num_frames = static_cast<double>(sights.boxes.size());
    const bool is_lone =
        sights.num_outside == 1 && sights.boxes.size() > 1;  // of few frames, too, a misread tag
    if (!is_lone && static_cast<double>(sights.num_outside) > kStrayFrames * num_frames)
      refuse_pictures(camera, sights, place);
    const std::string where =
        place ? place(*sights.first->frame, *sights.first->detection) + ": " : std::string();
    warnings.push_back(fmt::format(
        "{} of {} frames of camera '{}' have corners far outside its pictures, as misread tags and "
        "pictures of another size have: {}{}",
        sights.num_outside, sights.boxes.size(), camera.name, where, outside_corner(camera, sights, place)));
  }
  return warnings;
}

}  // namespace apriltrack
