#include "track_video.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "apriltrack/geometry/tag_view.h"
#include "pages/status_colours.h"

namespace apriltrack::app {
namespace {

constexpr double kOnlyFrameRate_hz = 10.0;  // of a recording of a single frame
constexpr double kMinRate_hz = 1.0, kMaxRate_hz = 240.0;

double rate_between(Timestamp first, Timestamp second) {
  return std::clamp(1.0 / seconds_between(first, second), kMinRate_hz, kMaxRate_hz);
}

/// Grazing tags and those seen from behind show nothing to compare an outline with.
bool faces_the_camera(const Pose& T_camera_tag) {
  constexpr double kMinCosine = 0.1;
  return tag_view_cosine(T_camera_tag) > kMinCosine;
}

std::string caption(const TrackResult& result, double time_s) {
  std::string text = fmt::format("{:.2f} s  {}", time_s, to_string(result.status));
  if (!result.pose) return result.reason.empty() ? text : fmt::format("{}: {}", text, result.reason);
  text += fmt::format("  tags: {} detected, {} used", result.tags_detected, result.tags_tracked);
  if (result.covariance) {
    const double sigma_m = std::sqrt(result.covariance->topLeftCorner<3, 3>().trace());
    text += fmt::format("  sigma {:.1f} mm", 1e3 * sigma_m);
  }
  return text;
}

}  // namespace

TrackVideo::TrackVideo(std::filesystem::path path, const Camera& camera, const TagMap& map, TrackMode mode)
    : path_(std::move(path)), camera_(camera), map_(map), mode_(mode) {}

std::vector<ColouredOutline> TrackVideo::outlines(const TrackResult& result) const {
  if (!result.pose) return {};
  const Pose T_camera_map = camera_from_map(*result.pose, mode_);
  std::vector<ColouredOutline> shown;
  for (const MapTag& tag : map_.tags) {
    if (!faces_the_camera(T_camera_map * tag.T_map_tag)) continue;
    ColouredOutline outline{{}, colour_of(result.status)};
    const auto corners_map = corners_in_map(tag);
    bool is_in_view = true;
    for (std::size_t i = 0; i < corners_map.size(); ++i) {
      const auto pixel = camera_.model.project(T_camera_map * corners_map[i]);
      is_in_view = is_in_view && pixel;
      if (pixel) outline.corners_px[i] = *pixel;
    }
    if (is_in_view) shown.push_back(outline);
  }
  return shown;
}

void TrackVideo::add(const SourceFrame& frame, const TrackResult& result) {
  if (!start_) start_ = frame.timestamp;
  const double time_s = seconds_between(*start_, frame.timestamp);
  show({frame.timestamp, frame.pixels, outlines(result), caption(result, time_s), colour_of(result.status)});
}

void TrackVideo::add_unreadable(Timestamp timestamp) {
  if (!last_) return;  // nothing to show yet
  const double time_s = seconds_between(*start_, timestamp);
  show({timestamp,
        last_->image,
        {},
        fmt::format("{:.2f} s  unreadable", time_s),
        colour_of(TrackStatus::kUnreadable)});
}

void TrackVideo::show(Shown shown) {
  if (last_ && !video_) {
    video_.emplace(path_, last_->image.width(), last_->image.height(),
                   rate_between(last_->timestamp, shown.timestamp));
    write(*last_);
  }
  if (video_) write(shown);
  last_ = std::move(shown);
}

void TrackVideo::write(const Shown& shown) {
  video_->add({shown.image.view(), shown.outlines, shown.caption, shown.colour});
}

void TrackVideo::close(StagedFiles& files) {
  if (last_ && !video_) {
    video_.emplace(path_, last_->image.width(), last_->image.height(), kOnlyFrameRate_hz);
    write(*last_);
  }
  if (video_) video_->close(files);
}

}  // namespace apriltrack::app
