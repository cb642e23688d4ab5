#include "frame_exposures.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "pixels_by_pose.h"

namespace apriltrack {
namespace {

/// Of the logarithm. Told: drivers round, count rows, or tell the frame's before.
constexpr double kToldSigma = 0.1;
/// From half the usual to twice; more by the tails.
constexpr double kUntoldSigma = 0.7;
constexpr double kLeastUsual_s = 1e-6;
/// More is a gap, or a false time stamp.
constexpr std::uint64_t kLongestInterval_ns = 10'000'000'000;
constexpr std::size_t kMostTags = 8;

/// How the corners of the tags that are explained move in the image, by the right perturbation of the pose.
Eigen::Matrix<double, Eigen::Dynamic, 6> pixels_by_pose(const PhotometricWorld& world, const MotionFit& fit) {
  const std::vector<TagEvidence> tags = explained_tags(fit.tags);
  const std::size_t num_tags = std::min(tags.size(), kMostTags);
  const PixelsByPose pixels(world, fit.state.pose);
  Eigen::Matrix<double, Eigen::Dynamic, 6> J(static_cast<Eigen::Index>(8 * num_tags), 6);
  Eigen::Index rows = 0;
  for (std::size_t i = 0; i < num_tags; ++i) {
    for (const Eigen::Vector3d& corner : corners_in_map(world.tag_at(tags[i].tag_index).tag)) {
      const auto by_pose = pixels.of(corner);
      if (!by_pose) continue;
      J.middleRows<2>(rows) = *by_pose;
      rows += 2;
    }
  }
  return J.topRows(rows);
}

}  // namespace

FrameExposures::FrameExposures(const MotionNoise& noise, double usual_s)
    : noise_(noise), usual_s_(usual_s), told_(kToldSigma), untold_(kUntoldSigma) {}

FrameExposure FrameExposures::next(Timestamp time, const std::optional<double>& told_s) {
  if (last_time_ && time.ns > last_time_->ns && nanoseconds_apart(time, *last_time_) <= kLongestInterval_ns) {
    pace_.add(time.ns - last_time_->ns);
    if (usual_s_ >= kLeastUsual_s)
      untold_.limit(1e-9 * static_cast<double>(pace_.frame_interval_ns()) / usual_s_);
  }
  last_time_ = time;
  FrameExposure result;
  result.is_told = told_s.has_value();
  result.base_s = told_s.value_or(usual_s_);
  const ExposureEstimate& known = estimate(result);
  result.exposure_s = result.base_s * known.factor();
  result.is_estimated = known.has_observed();
  result.sigma = known.sigma();
  return result;
}

double FrameExposures::claimed(Timestamp time, const FrameExposure& exposure, const PhotometricWorld& world,
                               const MotionFit& fit) {
  if (!(exposure.base_s >= kLeastUsual_s) || fit.tags.empty()) return 1.0;
  if (exposure.is_told != are_told_) instants_.clear();
  are_told_ = exposure.is_told;
  instants_.push_back({time, fit.state.pose, exposure.base_s,
                       exposure.exposure_s / exposure.base_s * fit.state.velocity,
                       pixels_by_pose(world, fit)});
  if (instants_.size() < 3) return 1.0;
  const auto seen = path_ratio({instants_[0], instants_[1], instants_[2]}, noise_);
  instants_.pop_front();
  if (!seen) return 1.0;
  ExposureEstimate& known = exposure.is_told ? told_ : untold_;
  known.observe(*seen);
  return exposure.exposure_s / (exposure.base_s * known.factor());
}

}  // namespace apriltrack
