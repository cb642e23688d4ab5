#include "pose_memory.h"

#include <algorithm>
#include <cmath>

namespace apriltrack {
namespace {

constexpr double kMaxVelocityGap_s =
    0.12;  // two poses further apart tell little of the velocity between frames
// A hand turns a camera by 10 rad/s at most; over 0.1 s faster turns are a change of mode: two planar poses
// differ by about a radian.
constexpr double kMaxAngularRate_rad_s = 15.0;
// Scatter of a lone tag's orientation that is some 50 px wide: the noise over the perspective, 1 to 2
// degrees.
constexpr double kPoseSigma_rad = 0.03;
// With no velocity known: half a quick turn of a hand-held camera, so that its whole is two sigma.
constexpr double kAngularRateSigma_rad_s = 4.0;
// The same camera shaken: 0.15 rad at 3 Hz has 0.15 (2 pi 3)^2 = 53 rad/s^2 at the turning points.
constexpr double kAngularAccelerationSigma_rad_s2 = 60.0;
constexpr double kFloor = 1e-3;

}  // namespace

const PoseMemory::Entry* PoseMemory::recent(Timestamp time) const {
  if (!entry_) return nullptr;
  const double age_s = seconds_between(entry_->time, time);
  return age_s > 0.0 && age_s <= kMaxAge_s ? &*entry_ : nullptr;
}

std::vector<PoseMemory::Mode> PoseMemory::predict(Timestamp time) const {
  const Entry* entry = recent(time);
  if (entry == nullptr) return {};
  std::vector<Mode> modes = entry->modes;
  if (entry->velocity) {
    modes.front().pose =
        modes.front().pose * Pose::exp(seconds_between(entry->time, time) * *entry->velocity);
  }
  return modes;
}

double PoseMemory::log_prior(Timestamp time, const Pose& pose) const {
  const Entry* entry = recent(time);
  if (entry == nullptr) return 0.0;
  const double age_s = seconds_between(entry->time, time);
  const double drift_rad = entry->velocity ? 0.5 * kAngularAccelerationSigma_rad_s2 * age_s * age_s
                                           : kAngularRateSigma_rad_s * age_s;
  const double sigma_rad = std::hypot(kPoseSigma_rad, std::min(drift_rad, kAngularRateSigma_rad_s * age_s));
  double density = kFloor;
  for (const Mode& mode : predict(time)) {
    const double sigmas = rotation_angle_rad(mode.pose.rotation(), pose.rotation()) / sigma_rad;
    density += mode.weight * std::exp(-0.5 * sigmas * sigmas);
  }
  return std::log(density / (1.0 + kFloor));
}

std::optional<PoseMemory::Last> PoseMemory::last(Timestamp time) const {
  const Entry* entry = recent(time);
  if (entry == nullptr) return std::nullopt;
  return Last{entry->modes.front().pose, seconds_between(entry->time, time)};
}

void PoseMemory::remember(Timestamp time, const Pose& pose, const std::optional<Mode>& second) {
  Entry entry{.time = time, .modes = {{pose, 1.0}}, .velocity = std::nullopt};
  if (second) entry.modes.push_back(*second);
  if (const Entry* before = recent(time)) {
    const double gap_s = seconds_between(before->time, time);
    const Vector6d velocity = (before->modes.front().pose.inverse() * pose).log() / gap_s;
    if (gap_s <= kMaxVelocityGap_s && velocity.tail<3>().norm() <= kMaxAngularRate_rad_s)
      entry.velocity = velocity;
  }
  entry_ = std::move(entry);
}

}  // namespace apriltrack
