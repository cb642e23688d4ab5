#include "mixed_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "picture_scales.h"

namespace apriltrack {
namespace {

constexpr std::size_t kLeastTags = 2;  // seen by both frames, at different places of the picture
constexpr double kMostLeft = 0.1;      // of the smaller picture's diagonal: what the camera moves meanwhile
constexpr double kOfJump = 0.35;       // of the way that corners go
constexpr std::size_t kFramesBeside = 10;  // that must lie in the smaller picture
constexpr double kBeyondSide = 0.02;       // of its sides
// Of a tag's outline, and of the change: it comes not much nearer from one frame to the next.
constexpr double kAsLarge = 0.16, kAsLargeOfChange = 0.4;

using Corners = std::vector<Eigen::Vector2d>;

Eigen::Vector2d size_of(const Camera& camera) {
  return {camera.width, camera.height};
}

/// Corners of the tags that both frames show once, in the same order.
std::pair<Corners, Corners> common_corners(const FrameDetections& before, const FrameDetections& after) {
  std::pair<Corners, Corners> common;
  for (const Detection& one : before.detections) {
    const auto is_it = [&](const Detection& other) { return other.tag == one.tag; };
    if (std::ranges::count_if(before.detections, is_it) != 1) continue;
    if (std::ranges::count_if(after.detections, is_it) != 1) continue;
    const Detection& other = *std::ranges::find_if(after.detections, is_it);
    common.first.insert(common.first.end(), one.corners_px.begin(), one.corners_px.end());
    common.second.insert(common.second.end(), other.corners_px.begin(), other.corners_px.end());
  }
  return common;
}

/// The largest distance between `from`, scaled about the picture's upper left corner, and `to`.
double largest_left(const Corners& from, const Corners& to, double scale) {
  double largest = 0.0;
  for (std::size_t i = 0; i < from.size(); ++i) largest = std::max(largest, (scale * from[i] - to[i]).norm());
  return largest;
}

double outline(const Corners& corners, std::size_t first) {
  double sum = 0.0;
  for (std::size_t k = 0; k < kNumCorners; ++k)
    sum += (corners[first + (k + 1) % kNumCorners] - corners[first + k]).norm();
  return sum;
}

bool are_tags_as_large(const Corners& smaller, const Corners& larger, double scale) {
  const double most_off = std::min(kAsLarge, kAsLargeOfChange * (1.0 - 1.0 / scale));
  for (std::size_t first = 0; first < smaller.size(); first += kNumCorners) {
    const double of_larger = outline(larger, first);
    if (!(std::abs(scale * outline(smaller, first) - of_larger) < most_off * of_larger)) return false;
  }
  return true;
}

/// Whether corners go to where pictures have them that are larger by `scale`.
bool are_same_corners(const Corners& smaller, const Corners& larger, double scale, const Camera& camera) {
  const double jump = largest_left(smaller, larger, 1.0), left = largest_left(larger, smaller, 1.0 / scale);
  return left < kMostLeft * size_of(camera).norm() / scale && left * scale < kOfJump * jump &&
         are_tags_as_large(smaller, larger, scale);
}

bool lies_within(const FrameDetections& frame, const Eigen::Vector2d& size) {
  return std::ranges::all_of(frame.detections, [&](const Detection& detection) {
    return std::ranges::all_of(detection.corners_px, [&](const Eigen::Vector2d& corner) {
      return !((corner - (1.0 + kBeyondSide) * size).maxCoeff() > 0.0);
    });
  });
}

/// Frames of one camera that show tags.
using Film = std::vector<const FrameDetections*>;

/// Those beside the change, on the side of the smaller pictures, lie in them; others of the larger do not.
bool are_sizes_seen(const Film& film, std::size_t first_after, bool is_smaller_after,
                    const Eigen::Vector2d& size) {
  const auto within = [&](std::size_t begin, std::size_t end) {
    std::size_t count = 0;
    for (std::size_t i = begin; i < end; ++i) count += lies_within(*film[i], size) ? 1 : 0;
    return count;
  };
  const std::size_t begin = first_after > kFramesBeside ? first_after - kFramesBeside : 0;
  const std::size_t end = std::min(film.size(), first_after + kFramesBeside);
  const std::size_t before = within(begin, first_after), after = within(first_after, end);
  return is_smaller_after ? after == end - first_after && before < first_after - begin
                          : before == first_after - begin && after < end - first_after;
}

struct Change {
  double scale = 0.0;  ///< From the smaller picture to the larger.
  bool is_smaller_after = false;
};

/// Between that frame and the one before.
std::optional<Change> change_at(const Film& film, std::size_t first_after, const Camera& camera) {
  const auto [before, after] = common_corners(*film[first_after - 1], *film[first_after]);
  if (before.size() < kLeastTags * kNumCorners) return std::nullopt;
  for (const double scale : kPictureScales) {
    for (const bool is_smaller_after : {true, false}) {
      if (are_same_corners(is_smaller_after ? after : before, is_smaller_after ? before : after, scale,
                           camera) &&
          are_sizes_seen(film, first_after, is_smaller_after, size_of(camera) / scale))
        return Change{scale, is_smaller_after};
    }
  }
  return std::nullopt;
}

std::string in_words(const Change& change, const Film& film, std::size_t first_after, const Camera& camera) {
  const long smaller = std::lround(camera.width / change.scale), larger = camera.width;
  return fmt::format(
      "pictures of camera '{}' change their size between {} and {} ns: all corners go to {:.3g} of where "
      "they were, as from {} to {} pixels of width. One camera file is of one size: bring all pictures to "
      "{} x {}, or make a map of each size with its own camera file",
      camera.name, film[first_after - 1]->timestamp.ns, film[first_after]->timestamp.ns,
      change.is_smaller_after ? 1.0 / change.scale : change.scale, change.is_smaller_after ? larger : smaller,
      change.is_smaller_after ? smaller : larger, camera.width, camera.height);
}

}  // namespace

std::optional<PictureSizeChange> change_of_picture_size(std::span<const FrameDetections> frames,
                                                        const Camera& camera) {
  Film film;
  for (const FrameDetections& frame : frames)
    if (frame.camera == camera.name && !frame.detections.empty()) film.push_back(&frame);
  for (std::size_t i = 1; i < film.size(); ++i)
    if (const auto change = change_at(film, i, camera))
      return PictureSizeChange{film[i], in_words(*change, film, i, camera)};
  return std::nullopt;
}

}  // namespace apriltrack
