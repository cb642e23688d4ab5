#include "image_size.h"

#include <fmt/format.h>

#include <string>

namespace apriltrack {
namespace {

/// "" where it may be this camera's.
std::string why_of_another_camera(const GrayView& image, const Camera& camera) {
  if (image.is_empty()) return "the image is empty";
  if (image.data() == nullptr) return "the image has no pixels: its data is null";
  if (image.stride() < 0) {
    return fmt::format(
        "the image's rows run upwards in memory (its stride is {}), and only rows that run downwards are "
        "read: copy "
        "it, the last row first",
        image.stride());
  }
  if (image.stride() < image.width()) {
    return fmt::format("the image's rows of {} pixels are {} bytes apart: rows cannot overlap", image.width(),
                       image.stride());
  }
  if (camera.width <= 0 || camera.height <= 0) return "";
  if (image.width() == camera.width && image.height() == camera.height) return "";
  return fmt::format("the image is {} x {} pixels, but the camera is calibrated for {} x {}", image.width(),
                     image.height(), camera.width, camera.height);
}

}  // namespace

std::optional<TrackResult> lost_to_another_camera(const Frame& frame, const Camera& camera) {
  TrackResult result;
  result.timestamp = frame.timestamp;
  result.reason = why_of_another_camera(frame.image, camera);
  if (result.reason.empty()) return std::nullopt;
  return result;
}

}  // namespace apriltrack
