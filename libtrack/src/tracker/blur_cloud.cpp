#include "blur_cloud.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>

#include "apriltrack/base/random.h"

namespace apriltrack {
namespace {

/// Further blur of the pictures, round by round, pixels of level 0: it widens the optimum's basin.
constexpr std::array kExtraSigma_px = {8.0, 6.0, 4.0, 2.4, 1.4};
constexpr int kLevel = 2;
constexpr int kPixelsPerTag = 196;
constexpr std::size_t kMaxSurvivors = 6;
constexpr double kMaxPriorCost = 15.0;  // -log of the prior: beyond, its Gaussian is not to be trusted
constexpr double kWideShare = 0.25;     // of the first round is drawn twice as wide

struct Particle {
  MotionState state;
  double score = 0.0;
};

/// A Gaussian to draw from.
struct Proposal {
  MotionState mean;
  Matrix12d covariance;
};

class Search {
 public:
  Search(PhotometricWorld& world, const PhotometricFrame& frame, const MotionBelief& belief,
         const CloudOptions& options)
      : world_(world), frame_(frame), belief_(belief), options_(options), prior_(belief.covariance) {}

  std::vector<Particle> run(const std::vector<MotionState>& seeds) {
    std::vector<Particle> elite;
    for (const MotionState& seed : seeds) elite.push_back({seed, 0.0});
    Proposal proposal{belief_.mean, belief_.covariance};
    for (std::size_t round = 0; round < kExtraSigma_px.size(); ++round) {
      std::vector<Particle> cloud = draw(proposal, round);
      cloud.insert(cloud.end(), elite.begin(), elite.end());
      for (Particle& particle : cloud) particle.score = score(particle.state, kExtraSigma_px[round]);
      std::stable_sort(cloud.begin(), cloud.end(),
                       [](const auto& a, const auto& b) { return a.score > b.score; });
      cloud.resize(std::min(cloud.size(), static_cast<std::size_t>(std::max(2, options_.num_particles / 8))));
      elite = std::move(cloud);
      proposal = fitted(elite);
    }
    return elite;
  }

  /// Distance of the poses in standard deviations of the belief.
  double distance(const MotionState& a, const MotionState& b) const {
    Vector12d d = Vector12d::Zero();
    d.head<6>() = (a.pose.inverse() * b.pose).log();
    return std::sqrt(d.head<6>().dot(pose_information() * d.head<6>()));
  }

 private:
  Matrix6d pose_information() const {
    return Matrix6d(belief_.covariance.topLeftCorner<6, 6>()).ldlt().solve(Matrix6d::Identity());
  }

  std::vector<Particle> draw(const Proposal& proposal, std::size_t round) const {
    const Matrix12d L = Eigen::LLT<Matrix12d>(proposal.covariance).matrixL();
    std::vector<Particle> cloud(static_cast<std::size_t>(options_.num_particles));
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      RandomStream random(options_.seed, options_.index, round * cloud.size() + i);
      const bool is_wide =
          round == 0 && static_cast<double>(i) < kWideShare * static_cast<double>(cloud.size());
      Vector12d z;
      for (double& value : z) value = random.normal();
      cloud[i].state = moved(proposal.mean, (is_wide ? 2.0 : 1.0) * (L * z));
    }
    return cloud;
  }

  double score(const MotionState& state, double extra_sigma_px) {
    const double evidence = log_likelihood(weigh_evidence(world_, frame_, state,
                                                          {.level = kLevel,
                                                           .max_pixels_per_tag = kPixelsPerTag,
                                                           .extra_sigma_px = extra_sigma_px,
                                                           .is_robust = false}));
    const Vector12d d = difference(belief_.mean, state);
    return evidence - std::min(kMaxPriorCost, 0.5 * d.dot(prior_.solve(d)));
  }

  Proposal fitted(const std::vector<Particle>& elite) const {
    const MotionState& origin = elite.front().state;
    Vector12d mean = Vector12d::Zero();
    for (const Particle& particle : elite) mean += difference(origin, particle.state);
    mean /= static_cast<double>(elite.size());
    Matrix12d covariance = Matrix12d::Zero();
    for (const Particle& particle : elite) {
      const Vector12d d = difference(origin, particle.state) - mean;
      covariance += d * d.transpose() / static_cast<double>(elite.size());
    }
    // A cloud of thirty cannot tell its own width in twelve directions: it keeps a part of where it began.
    covariance += 1e-3 * belief_.covariance;
    return {moved(origin, mean), covariance};
  }

  PhotometricWorld& world_;
  const PhotometricFrame& frame_;
  const MotionBelief& belief_;
  const CloudOptions& options_;
  Eigen::LDLT<Matrix12d> prior_;
};

}  // namespace

std::vector<MotionState> search_cloud(PhotometricWorld& world, const PhotometricFrame& frame,
                                      const MotionBelief& belief, const std::vector<MotionState>& seeds,
                                      const CloudOptions& options) {
  constexpr double kSeparation = 0.3;
  Search search(world, frame, belief, options);
  std::vector<MotionState> survivors;
  for (const Particle& particle : search.run(seeds)) {
    if (survivors.size() == kMaxSurvivors) break;
    const bool is_apart = std::all_of(survivors.begin(), survivors.end(), [&](const MotionState& other) {
      return search.distance(other, particle.state) > kSeparation;
    });
    if (is_apart) survivors.push_back(particle.state);
  }
  return survivors;
}

}  // namespace apriltrack
