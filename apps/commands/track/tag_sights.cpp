#include "tag_sights.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "apriltrack/base/check.h"

namespace apriltrack::app {
namespace {

constexpr std::array<SightStatus, 8> kStatuses = {
    SightStatus::kDetected,  SightStatus::kTracked, SightStatus::kOccluded, SightStatus::kHidden,
    SightStatus::kElsewhere, SightStatus::kSuspect, SightStatus::kUnjudged, SightStatus::kUnmapped};

bool rests_on_tags(const TrackResult& result) {
  return result.pose && (result.status == TrackStatus::kDetected || result.status == TrackStatus::kTracked);
}

SightStatus status_of(const TagReport& report) {
  switch (report.state) {
    case TagState::kUsed:
      return report.is_read ? SightStatus::kDetected : SightStatus::kTracked;
    case TagState::kOccluded:
      return SightStatus::kOccluded;
    case TagState::kHidden:
      return SightStatus::kHidden;
    case TagState::kElsewhere:
      return SightStatus::kElsewhere;
    case TagState::kSuspect:
      return SightStatus::kSuspect;
  }
  APRILTRACK_CHECK(false, "not a TagState");
}

TagSight sight_of(const TagKey& tag, SightStatus status) {
  TagSight sight;
  sight.tag = tag;
  sight.status = status;
  return sight;
}

TagSight sight_of(const TagReport& report) {
  TagSight sight = sight_of(report.tag, status_of(report));
  sight.is_read = report.is_read;
  sight.log_odds = report.log_odds;
  sight.expected_share = report.expected_share;
  sight.found_share = report.found_share;
  sight.shift_px = report.shift_px;
  return sight;
}

/// Of a tag that was read, where the method reports none.
SightStatus status_of_read(const TagKey& tag, const TrackResult& result, const TagMap& map) {
  if (!map.find(tag)) return SightStatus::kUnmapped;
  if (!rests_on_tags(result)) return SightStatus::kUnjudged;
  const bool contradicts =
      std::ranges::find(result.contradicting_tags, tag) != result.contradicting_tags.end();
  return contradicts ? SightStatus::kElsewhere : SightStatus::kDetected;
}

/// Corners at the pose, and what they may be off by.
class Projection {
 public:
  Projection(const TrackResult& result, const SightContext& context)
      : result_(result),
        context_(context),
        T_camera_map_(camera_from_map(*result.pose, context.mode)),
        view_by_pose_(view_by_pose(*result.pose, context.mode)) {}

  void add_to(TagSight& sight) const {
    const MapTag* tag = context_.map.find(sight.tag);
    if (!tag) return;
    std::array<Eigen::Vector2d, 4> corners_px;
    double variance_px2 = 0.0;
    const auto corners_map = corners_in_map(*tag);
    for (std::size_t i = 0; i < corners_map.size(); ++i) {
      const Eigen::Vector3d corner_camera = T_camera_map_ * corners_map[i];
      Eigen::Matrix<double, 2, 3> by_corner;
      const auto pixel = context_.camera.model.project(corner_camera, &by_corner);
      if (!pixel) return;
      corners_px[i] = *pixel;
      if (result_.covariance) variance_px2 += variance_of(corner_camera, by_corner);
    }
    sight.projected_px = corners_px;
    if (result_.covariance) sight.sigma_px = std::sqrt(variance_px2 / 4.0);
  }

 private:
  double variance_of(const Eigen::Vector3d& corner_camera,
                     const Eigen::Matrix<double, 2, 3>& by_corner) const {
    // exp([rho; phi]) on the left moves a point p by rho + phi x p.
    Eigen::Matrix<double, 3, 6> by_view;
    by_view.leftCols<3>().setIdentity();
    by_view.rightCols<3>() << 0.0, corner_camera.z(), -corner_camera.y(), -corner_camera.z(), 0.0,
        corner_camera.x(), corner_camera.y(), -corner_camera.x(), 0.0;
    const Eigen::Matrix<double, 2, 6> by_pose = by_corner * by_view * view_by_pose_;
    return (by_pose * *result_.covariance * by_pose.transpose()).trace();
  }

  const TrackResult& result_;
  const SightContext& context_;
  const Pose T_camera_map_;
  const Matrix6d view_by_pose_;
};

/// The nearest of a tag's readings: it may hang twice.
void add_residual(std::span<const Detection> detections, TagSight& sight) {
  if (!sight.projected_px) return;
  for (const Detection& detection : detections) {
    if (detection.tag != sight.tag) continue;
    double sum_px2 = 0.0;
    for (std::size_t i = 0; i < detection.corners_px.size(); ++i)
      sum_px2 += (detection.corners_px[i] - (*sight.projected_px)[i]).squaredNorm();
    const double residual_px = std::sqrt(sum_px2 / 4.0);
    sight.residual_px = std::min(residual_px, sight.residual_px.value_or(residual_px));
  }
}

}  // namespace

std::span<const SightStatus> sight_statuses() {
  return kStatuses;
}

std::string to_string(SightStatus status) {
  constexpr std::array<const char*, kStatuses.size()> kWords = {
      "detected", "tracked", "occluded", "hidden", "elsewhere", "suspect", "unjudged", "unmapped"};
  return kWords.at(static_cast<std::size_t>(status));
}

std::vector<TagSight> tag_sights(const TrackResult& result, std::span<const Detection> detections,
                                 const SightContext& context) {
  std::map<TagKey, TagSight> sights;
  for (const TagReport& report : result.tags) sights.emplace(report.tag, sight_of(report));
  for (const Detection& detection : detections) {
    const TagKey& tag = detection.tag;
    const auto [sight, is_new] = sights.emplace(tag, sight_of(tag, status_of_read(tag, result, context.map)));
    sight->second.is_read = true;
  }
  for (const TagKey& tag : result.contradicting_tags)
    sights.emplace(tag, sight_of(tag, SightStatus::kSuspect));
  std::vector<TagSight> sorted;
  for (auto& [tag, sight] : sights) {
    if (result.pose) Projection(result, context).add_to(sight);
    add_residual(detections, sight);
    sorted.push_back(std::move(sight));
  }
  return sorted;
}

}  // namespace apriltrack::app
