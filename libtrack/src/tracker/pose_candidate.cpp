#include "pose_candidate.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "pose_adjustment.h"

namespace apriltrack {
namespace {

constexpr double kSearchSlack_px = 2.0;  // a blurred corner is a few pixels off
constexpr std::size_t kMaxRefined = 6;   // two poses for each of three tags, or less
constexpr double kSameStart_rad = 0.02;  // starts this near slide into one minimum
constexpr double kSamePose_rad = 1e-3;   // converged minima
constexpr double kSameSigmas = 3.0;      // Mahalanobis: settled on one tag more or less
constexpr double kOutlierSigmas = 3.0;
constexpr double kMinGate_px = 1.0;  // a bent print or a map of a millimetre's accuracy is no outlier
constexpr RobustKernel kSearchKernel{RobustKernel::Shape::kCauchy, 1.0};
constexpr int kMaxRefits = 4;

struct Start {
  Pose T_camera_map;
  double cost = 0.0;
};

bool are_near(const Pose& a, const Pose& b, double limit) {
  const Eigen::Vector3d eye_a = a.inverse().translation();
  const Eigen::Vector3d eye_b = b.inverse().translation();
  return rotation_angle_rad(a.rotation(), b.rotation()) < limit &&
         (eye_a - eye_b).norm() < limit * std::max(a.translation().norm(), b.translation().norm());
}

/// Every tag's poses and the predictions, best first.
std::vector<Start> ranked_starts(const CameraModel& model,
                                 const std::vector<const TagObservation*>& observations,
                                 const std::vector<Pose>& predictions) {
  std::vector<Start> starts;
  for (const Pose& T_camera_map : predictions) starts.push_back({T_camera_map});
  for (const TagObservation* observation : observations) {
    for (const PlanarPose& pose : observation->planar_poses) {
      starts.push_back({pose.T_camera_tag * observation->tag->T_map_tag.inverse()});
    }
  }
  for (Start& start : starts)
    start.cost = robust_cost(model, observations, kSearchKernel, start.T_camera_map);
  std::stable_sort(starts.begin(), starts.end(),
                   [](const Start& a, const Start& b) { return a.cost < b.cost; });
  return starts;
}

/// A tag's mean squared error over what it may be: kOutlierSigmas of noise_scale times its expected noise,
/// and gate_px beside. At most 1 where the tag agrees.
double over_gate(const TagObservation& observation, const CornerErrors& errors_px, double noise_scale,
                 double gate_px) {
  const double in_pixels = errors_px.squaredNorm() / (2.0 * kNumCorners * gate_px * gate_px);
  if (in_pixels <= 1.0) return in_pixels;  // an upper bound
  const CornerCovariance covariance_px2 =
      kOutlierSigmas * kOutlierSigmas * noise_scale * noise_scale * observation.covariance_px2 +
      gate_px * gate_px * CornerCovariance::Identity();
  return errors_px.dot(covariance_px2.llt().solve(errors_px)) / (2.0 * kNumCorners);
}

struct Copy {
  const TagObservation* observation = nullptr;
  double squared_error = 0.0, minus_twice_log_likelihood = 0.0;
};

/// Of each tag, the copy that is likeliest: one that claims little must fit as much better.
template <class Error>
std::map<const MapTag*, Copy> likeliest_copies(const std::vector<const TagObservation*>& observations,
                                               const Error& squared_error_of) {
  std::map<const MapTag*, Copy> copies;
  for (const TagObservation* observation : observations) {
    const double error = squared_error_of(*observation);
    const Copy copy{observation, error, error + observation->log_determinant};
    const auto [entry, is_new] = copies.emplace(observation->tag, copy);
    if (!is_new && copy.minus_twice_log_likelihood < entry->second.minus_twice_log_likelihood)
      entry->second = copy;
  }
  return copies;
}

/// The tags that fit as well as the better half of them does, one copy of each.
std::vector<const TagObservation*> agreeing_tags(const CameraModel& model,
                                                 const std::vector<const TagObservation*>& observations,
                                                 const CandidateOptions& options, const Pose& T_camera_map) {
  const auto error_of = [&](const TagObservation& observation) {
    return squared_error(model, observation, T_camera_map);
  };
  std::vector<double> rms;
  std::set<const TagObservation*> best_copies;
  for (const auto& [tag, copy] : likeliest_copies(observations, error_of)) {
    best_copies.insert(copy.observation);
    rms.push_back(std::sqrt(copy.squared_error / (2.0 * kNumCorners)));
  }
  const auto middle = rms.begin() + static_cast<std::ptrdiff_t>((rms.size() - 1) / 2);
  std::nth_element(rms.begin(), middle, rms.end());
  const double noise_scale = std::max(1.0, *middle);
  std::vector<const TagObservation*> inliers;
  for (const TagObservation* observation : observations) {  // in the observations' order: pointers have none
    if (!best_copies.contains(observation)) continue;
    const auto errors_px = corner_errors_px(model, *observation, T_camera_map);
    if (!errors_px || !(over_gate(*observation, *errors_px, 1.0, options.max_residual_rms_px) <= 1.0))
      continue;
    if (!std::isfinite(noise_scale) || over_gate(*observation, *errors_px, noise_scale, kMinGate_px) <= 1.0)
      inliers.push_back(observation);
  }
  return inliers;
}

/// Refines on all tags, drops those that disagree, refits to the rest until none changes sides.
/// search: the observations with kSearchSlack_px.
PoseCandidate settle(const CameraModel& model, const std::vector<const TagObservation*>& observations,
                     const std::vector<const TagObservation*>& search, const CandidateOptions& options,
                     const Pose& start) {
  PoseCandidate candidate;
  candidate.T_camera_map = adjust_pose(model, search, kSearchKernel, start);
  const auto squared_error_of_inliers = [&] {
    double sum = 0.0;
    for (const auto* tag : candidate.inliers) sum += squared_error(model, *tag, candidate.T_camera_map);
    return sum;
  };
  for (int i = 0; i < kMaxRefits; ++i) {
    auto inliers = agreeing_tags(model, observations, options, candidate.T_camera_map);
    if (inliers == candidate.inliers) break;
    candidate.inliers = std::move(inliers);
    if (candidate.inliers.empty()) break;
    const double rms = std::sqrt(squared_error_of_inliers() / (2.0 * candidate.num_corners()));
    const double scale = kOutlierSigmas * std::max(rms, 1.0);
    candidate.T_camera_map =
        adjust_pose(model, candidate.inliers, {RobustKernel::Shape::kHuber, scale}, candidate.T_camera_map);
  }
  candidate.squared_error = squared_error_of_inliers();
  return candidate;
}

/// Of all inliers together.
bool fits(const CameraModel& model, const PoseCandidate& candidate, const CandidateOptions& options) {
  double sum = 0.0;
  for (const auto* tag : candidate.inliers) {
    const auto errors_px = corner_errors_px(model, *tag, candidate.T_camera_map);
    if (!errors_px) return false;
    sum += over_gate(*tag, *errors_px, 1.0, options.max_residual_rms_px);
  }
  return sum <= static_cast<double>(candidate.inliers.size());
}

std::vector<const TagObservation*> pointers_to(const std::vector<TagObservation>& observations) {
  std::vector<const TagObservation*> pointers;
  for (const TagObservation& observation : observations) pointers.push_back(&observation);
  return pointers;
}

}  // namespace

std::vector<PoseCandidate> find_pose_candidates(const CameraModel& model,
                                                const std::vector<TagObservation>& observations,
                                                const std::vector<Pose>& predictions,
                                                const CandidateOptions& options) {
  const std::vector<const TagObservation*> all = pointers_to(observations);
  std::vector<TagObservation> with_slack;
  for (const TagObservation& observation : observations)
    with_slack.push_back(with_further_noise(observation, kSearchSlack_px));
  const std::vector<const TagObservation*> search = pointers_to(with_slack);

  std::vector<Pose> refined_starts;
  std::vector<PoseCandidate> candidates;
  for (const Start& start : ranked_starts(model, search, predictions)) {
    if (refined_starts.size() == kMaxRefined) break;
    const auto is_near_start = [&](const Pose& pose) {
      return are_near(pose, start.T_camera_map, kSameStart_rad);
    };
    if (std::any_of(refined_starts.begin(), refined_starts.end(), is_near_start)) continue;
    refined_starts.push_back(start.T_camera_map);

    PoseCandidate candidate = settle(model, all, search, options, start.T_camera_map);
    if (candidate.inliers.empty() || !candidate.T_camera_map.is_finite()) continue;
    if (!fits(model, candidate, options)) continue;
    const auto is_same = [&](const PoseCandidate& other) {
      return are_near(other.T_camera_map, candidate.T_camera_map, kSamePose_rad);
    };
    if (std::none_of(candidates.begin(), candidates.end(), is_same))
      candidates.push_back(std::move(candidate));
  }
  return candidates;
}

bool is_same_explanation(const Pose& winner, const Matrix6d& cov_winner, const Pose& other) {
  const Vector6d xi = (winner.inverse() * other).log();
  return xi.dot(cov_winner.llt().solve(xi)) < kSameSigmas * kSameSigmas;
}

double misfit(const CameraModel& model, const std::vector<TagObservation>& observations, double noise_scale,
              const Pose& T_camera_map) {
  constexpr double kOutlierMisfit = 0.5 * 2.0 * kNumCorners * kOutlierSigmas * kOutlierSigmas;
  const auto error_of = [&](const TagObservation& observation) {
    return squared_error(model, observation, T_camera_map) / (noise_scale * noise_scale);
  };
  double sum = 0.0;
  for (const auto& [tag, copy] : likeliest_copies(pointers_to(observations), error_of))
    sum += std::min(0.5 * copy.squared_error, kOutlierMisfit);
  return sum;
}

}  // namespace apriltrack
