#include "pose_candidate.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>

#include "pose_adjustment.h"

namespace apriltrack {
namespace {

constexpr double kSearchScale_px = 2.0;  // of the Cauchy kernel: a blurred corner is a few pixels off
constexpr std::size_t kMaxRefined = 6;   // two poses for each of three tags, or less
constexpr double kSameStart_rad = 0.02;  // starts this near slide into one minimum
constexpr double kSamePose_rad = 1e-3;   // converged minima
constexpr double kSameSigmas = 3.0;      // Mahalanobis: settled on one tag more or less
constexpr double kOutlierSigmas = 3.0;
constexpr double kMinGate_px = 1.0;  // a bent print or a map of a millimetre's accuracy is no outlier
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
  const RobustKernel kernel{RobustKernel::Shape::kCauchy, kSearchScale_px};
  for (Start& start : starts) start.cost = robust_cost(model, observations, kernel, start.T_camera_map);
  std::stable_sort(starts.begin(), starts.end(),
                   [](const Start& a, const Start& b) { return a.cost < b.cost; });
  return starts;
}

double tag_rms_px(double squared_error_px2) {
  return std::sqrt(squared_error_px2 / (2.0 * kNumCorners));
}

/// The tags that fit as well as the better half of them does, one copy of each.
std::vector<const TagObservation*> agreeing_tags(const CameraModel& model,
                                                 const std::vector<const TagObservation*>& observations,
                                                 const CandidateOptions& options, const Pose& T_camera_map) {
  std::map<std::pair<const MapTag*, double>, const TagObservation*> by_tag_and_rms;
  for (const TagObservation* observation : observations) {
    const double rms_px = tag_rms_px(squared_error_px2(model, *observation, T_camera_map));
    by_tag_and_rms.emplace(std::pair(observation->tag, rms_px), observation);
  }
  std::vector<std::pair<double, const TagObservation*>> best_copies;
  const MapTag* last_tag = nullptr;
  for (const auto& [key, observation] : by_tag_and_rms) {
    if (key.first != last_tag) best_copies.emplace_back(key.second, observation);
    last_tag = key.first;
  }
  std::vector<double> rms_px;
  for (const auto& copy : best_copies) rms_px.push_back(copy.first);
  const auto middle = rms_px.begin() + static_cast<std::ptrdiff_t>((rms_px.size() - 1) / 2);
  std::nth_element(rms_px.begin(), middle, rms_px.end());
  const double gate_px =
      std::min(std::max(kOutlierSigmas * std::max(*middle, options.expected_sigma_px), kMinGate_px),
               options.max_residual_rms_px);
  std::vector<const TagObservation*> inliers;
  for (const TagObservation* observation : observations) {  // in the observations' order: pointers have none
    const bool is_inlier = std::any_of(best_copies.begin(), best_copies.end(), [&](const auto& copy) {
      return copy.second == observation && copy.first <= gate_px;
    });
    if (is_inlier) inliers.push_back(observation);
  }
  return inliers;
}

/// Refines on all tags, drops those that disagree, refits to the rest until none changes sides.
PoseCandidate settle(const CameraModel& model, const std::vector<const TagObservation*>& observations,
                     const CandidateOptions& options, const Pose& start) {
  const RobustKernel search{RobustKernel::Shape::kCauchy, kSearchScale_px};
  PoseCandidate candidate;
  candidate.T_camera_map = adjust_pose(model, observations, search, start);
  for (int i = 0; i < kMaxRefits; ++i) {
    auto inliers = agreeing_tags(model, observations, options, candidate.T_camera_map);
    if (inliers == candidate.inliers) break;
    candidate.inliers = std::move(inliers);
    if (candidate.inliers.empty()) break;
    double squared_error = 0.0;
    for (const auto* tag : candidate.inliers)
      squared_error += squared_error_px2(model, *tag, candidate.T_camera_map);
    const double rms_px = std::sqrt(squared_error / (2.0 * candidate.num_corners()));
    const double scale_px = kOutlierSigmas * std::max(rms_px, options.expected_sigma_px);
    candidate.T_camera_map = adjust_pose(model, candidate.inliers, {RobustKernel::Shape::kHuber, scale_px},
                                         candidate.T_camera_map);
  }
  candidate.squared_error_px2 = 0.0;
  for (const auto* tag : candidate.inliers) {
    candidate.squared_error_px2 += squared_error_px2(model, *tag, candidate.T_camera_map);
  }
  return candidate;
}

}  // namespace

double PoseCandidate::rms_px() const {
  return std::sqrt(squared_error_px2 / (2.0 * num_corners()));
}

std::vector<PoseCandidate> find_pose_candidates(const CameraModel& model,
                                                const std::vector<TagObservation>& observations,
                                                const std::vector<Pose>& predictions,
                                                const CandidateOptions& options) {
  std::vector<const TagObservation*> all;
  for (const TagObservation& observation : observations) all.push_back(&observation);

  std::vector<Pose> refined_starts;
  std::vector<PoseCandidate> candidates;
  for (const Start& start : ranked_starts(model, all, predictions)) {
    if (refined_starts.size() == kMaxRefined) break;
    const auto is_near_start = [&](const Pose& pose) {
      return are_near(pose, start.T_camera_map, kSameStart_rad);
    };
    if (std::any_of(refined_starts.begin(), refined_starts.end(), is_near_start)) continue;
    refined_starts.push_back(start.T_camera_map);

    PoseCandidate candidate = settle(model, all, options, start.T_camera_map);
    if (candidate.inliers.empty() || !candidate.T_camera_map.is_finite()) continue;
    if (!(candidate.rms_px() <= options.max_residual_rms_px)) continue;
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

double misfit(const CameraModel& model, const std::vector<TagObservation>& observations, double sigma_px,
              const Pose& T_camera_map) {
  constexpr double kOutlierMisfit = 0.5 * 2.0 * kNumCorners * kOutlierSigmas * kOutlierSigmas;
  std::map<const MapTag*, double> best;
  for (const TagObservation& observation : observations) {
    const double error = squared_error_px2(model, observation, T_camera_map) / (2.0 * sigma_px * sigma_px);
    const auto [entry, is_new] = best.emplace(observation.tag, std::min(error, kOutlierMisfit));
    if (!is_new) entry->second = std::min(entry->second, error);
  }
  double sum = 0.0;
  for (const auto& [tag, error] : best) sum += error;
  return sum;
}

}  // namespace apriltrack
