#include "blur_cloud.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "apriltrack/base/check.h"
#include "apriltrack/base/random.h"
#include "apriltrack/photometric/motion_fit.h"
#include "largest_tags.h"

namespace apriltrack {
namespace {

/// Further blur of the pictures, stage by stage, pixels of level 0: it widens the optimum's basin.
constexpr std::array kExtraSigma_px = {8.0, 4.0, 1.4};
/// What is left for each stage to descend.
constexpr std::array<std::size_t, 3> kNumDescended = {12, 8, 6};
constexpr int kLevel = 2;
constexpr int kPixelsPerTag = 96;
/// Of all of the cloud, of which one in twenty is looked at again.
constexpr int kPixelsPerTagFirst = 32;
constexpr int kSteps = 4;
constexpr std::size_t kMaxSurvivors = 6;
constexpr double kMaxPriorCost = 15.0;  // -log of the prior: beyond, its Gaussian is not to be trusted
constexpr double kWideShare = 0.25;     // of the cloud is drawn twice as wide
/// Standard deviations of the belief's pose between states worth descending from.
constexpr double kSeparation = 0.3;

struct Particle {
  MotionState state;
  std::size_t belief = 0;  ///< That it is judged by.
  double score = 0.0;
};

/// One of the things that the motion may be, and how far states are from it.
class Prior {
 public:
  explicit Prior(const MotionBelief& belief)
      : belief_(belief),
        factor_(belief.covariance),
        pose_information_(inverse(belief.covariance.topLeftCorner<6, 6>())),
        velocity_information_(inverse(belief.covariance.bottomRightCorner<6, 6>())) {}

  const MotionBelief& belief() const { return belief_; }

  double cost(const MotionState& state) const {
    const Vector12d d = difference(belief_.mean, state);
    return std::min(kMaxPriorCost, 0.5 * d.dot(factor_.solve(d)));
  }

  /// Of the poses, in standard deviations of the belief; or of their velocities, where these are farther
  /// apart.
  double distance(const MotionState& a, const MotionState& b) const {
    const Vector12d d = difference(a, b);
    return std::sqrt(std::max(d.head<6>().dot(pose_information_ * d.head<6>()),
                              d.tail<6>().dot(velocity_information_ * d.tail<6>())));
  }

 private:
  static Matrix6d inverse(const Matrix6d& covariance) {
    return covariance.ldlt().solve(Matrix6d::Identity());
  }

  const MotionBelief& belief_;
  Eigen::LDLT<Matrix12d> factor_;
  Matrix6d pose_information_, velocity_information_;
};

class Search {
 public:
  Search(PhotometricWorld& world, const PhotometricFrame& frame, const std::vector<MotionBelief>& beliefs,
         const CloudOptions& options)
      : world_(world), frame_(frame), options_(options), priors_(beliefs.begin(), beliefs.end()) {}

  /// Best first, apart from each other.
  std::vector<Particle> run(const std::vector<MotionState>& seeds) {
    std::vector<Particle> cloud = draw();
    for (const MotionState& seed : seeds) cloud.push_back({seed, likeliest(seed)});
    rank(cloud, kExtraSigma_px.front(), kPixelsPerTagFirst);
    for (std::size_t stage = 0; stage < kExtraSigma_px.size(); ++stage) {
      cloud = best_apart(cloud, kNumDescended[stage]);
      for (Particle& particle : cloud) descend(particle, kExtraSigma_px[stage]);
      rank(cloud, kExtraSigma_px[std::min(stage + 1, kExtraSigma_px.size() - 1)], kPixelsPerTag);
    }
    return best_apart(cloud, kMaxSurvivors);
  }

 private:
  /// As many about each belief.
  std::vector<Particle> draw() const {
    std::vector<Matrix12d> roots;
    for (const Prior& prior : priors_)
      roots.push_back(Eigen::LLT<Matrix12d>(prior.belief().covariance).matrixL());
    std::vector<Particle> cloud(static_cast<std::size_t>(options_.num_particles));
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      cloud[i].belief = i % priors_.size();
      RandomStream random(options_.seed, options_.index, i);
      const bool is_wide = static_cast<double>(i) < kWideShare * static_cast<double>(cloud.size());
      Vector12d z;
      for (double& value : z) value = random.normal();
      cloud[i].state =
          moved(priors_[cloud[i].belief].belief().mean, (is_wide ? 2.0 : 1.0) * (roots[cloud[i].belief] * z));
    }
    return cloud;
  }

  std::size_t likeliest(const MotionState& state) const {
    const auto best =
        std::ranges::min_element(priors_, {}, [&](const Prior& prior) { return prior.cost(state); });
    return static_cast<std::size_t>(best - priors_.begin());
  }

  void rank(std::vector<Particle>& cloud, double extra_sigma_px, int pixels_per_tag) {
    for (Particle& particle : cloud) particle.score = score(particle, extra_sigma_px, pixels_per_tag);
    std::stable_sort(cloud.begin(), cloud.end(),
                     [](const auto& a, const auto& b) { return a.score > b.score; });
  }

  std::vector<Particle> best_apart(const std::vector<Particle>& ranked, std::size_t max_count) const {
    std::vector<Particle> best;
    for (const Particle& particle : ranked) {
      if (best.size() == max_count) break;
      const bool is_apart = std::ranges::all_of(best, [&](const Particle& other) {
        return priors_[particle.belief].distance(other.state, particle.state) > kSeparation;
      });
      if (is_apart) best.push_back(particle);
    }
    return best;
  }

  void descend(Particle& particle, double extra_sigma_px) {
    particle.state = descend_motion(world_, frame_, particle.state, priors_[particle.belief].belief(),
                                    {.coarsest_level = kLevel,
                                     .finest_level = kLevel,
                                     .max_steps_per_level = kSteps,
                                     .max_pixels_per_tag = kPixelsPerTag,
                                     .extra_sigma_px = extra_sigma_px});
  }

  double score(const Particle& particle, double extra_sigma_px, int pixels_per_tag) {
    const double evidence = log_likelihood(weigh_evidence(world_, frame_, particle.state,
                                                          {.level = kLevel,
                                                           .max_pixels_per_tag = pixels_per_tag,
                                                           .extra_sigma_px = extra_sigma_px,
                                                           .is_robust = false}));
    return evidence - priors_[particle.belief].cost(particle.state);
  }

  PhotometricWorld& world_;
  const PhotometricFrame& frame_;
  const CloudOptions& options_;
  std::vector<Prior> priors_;
};

}  // namespace

std::vector<CloudState> search_cloud(PhotometricWorld& world, const PhotometricFrame& frame,
                                     const std::vector<MotionBelief>& beliefs,
                                     const std::vector<MotionState>& seeds, const CloudOptions& options) {
  APRILTRACK_CHECK(!beliefs.empty(), "a cloud is drawn about beliefs");
  std::vector<MotionState> means;
  for (const MotionBelief& belief : beliefs) means.push_back(belief.mean);
  const LargestTags some_tags(world, means);
  std::vector<CloudState> survivors;
  for (const Particle& particle : Search(world, frame, beliefs, options).run(seeds))
    survivors.push_back({particle.state, particle.belief});
  return survivors;
}

}  // namespace apriltrack
