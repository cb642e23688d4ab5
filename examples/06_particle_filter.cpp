// A particle filter of one's own on JointLikelihood, through motion blur; its error beside that of
// BlurTracker.
//
// The textbook filter (move the cloud, weigh it, resample) gets lost here: a frame tells the pose to a
// milliradian, and where the camera turned since the last frame is known to some forty. Of a thousand
// particles none lies in the peak, one takes all the weight, and the next cloud is copies of a wrong state.
// What helps:
//  1. Constant velocity under an unknown acceleration (predict): pose and velocity err together, so that a
//     pose that is found tells the velocity as well.
//  2. Tempering. A frame is weighed in stages: weights to a power that leaves a tenth of the cloud alive say
//     where to draw next, until the power is nearly 1. The cloud walks into the peak.
//  3. The weight is prior * likelihood / density drawn from, at every stage. Resampling and jittering instead
//     forgets the prior, and drifts along what tags tell least: sideways and turning look alike.
//  4. Fresh draws from a Student t of the cloud's mean and covariance: no copies, and tails that forgive.
//  5. A detected pose moves the first draws, never the weights: fewer stages, and nothing counts twice.
#include <apriltrack/apriltrack.h>
#include <apriltrack/base/parallel.h>
#include <apriltrack/base/random.h>
#include <apriltrack/eval/evaluate_trajectory.h>
#include <apriltrack/eval/trajectory_formats.h>
#include <apriltrack/filter/log_weights.h>
#include <apriltrack/photometric/joint_likelihood.h>
#include <apriltrack/source/frame_source.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>
#include <vector>

using namespace apriltrack;

class ParticleFilter {
 public:
  // 20 x 20 samples a tag: more of them make the peak narrower, and so take more time and more stages.
  ParticleFilter(const Camera& camera, const TagMap& map)
      : camera_(camera),
        likelihood_(camera, map, TrackMode::kEgo, {.grid = {.size = 20}}),
        localizer_(camera, map) {}

  /// T_world_camera and velocity with their covariance; null while lost.
  const MotionBelief* track(const Frame& frame) {
    fill_light_pyramid(frame.image, camera_.response, 1, light_.light);  // linear: blur is a mean of light
    light_.exposure_s = frame.exposure_s.value_or(camera_.exposure_s.value_or(0.01));
    const TrackResult detected = localizer_.localize(frame);
    if (belief_) belief_ = predict(*belief_, MotionNoise{}, seconds_between(last_, frame.timestamp));
    last_ = frame.timestamp;
    if (!belief_ && detected.pose) belief_ = at_start(detected);
    if (!belief_) return nullptr;
    belief_ = weigh_in_stages(*belief_, first_proposal(*belief_, detected));
    // A frame that says nothing leaves the prior, which grows until nothing is known any more.
    if (belief_->covariance.topLeftCorner<3, 3>().trace() > 0.5 * 0.5) belief_.reset();
    return belief_ ? &*belief_ : nullptr;
  }

 private:
  static MotionBelief at_start(const TrackResult& detected) {
    MotionBelief belief{{*detected.pose}, Matrix12d::Zero()};
    belief.covariance.topLeftCorner<6, 6>() = *detected.covariance;
    belief.covariance.diagonal().tail<6>() << 1, 1, 1, 4, 4, 4;  // 1 m/s and 2 rad/s: a hand
    return belief;
  }

  static MotionBelief first_proposal(MotionBelief proposal, const TrackResult& detected) {
    if (!detected.pose) return proposal;
    // A Kalman step, by twice the claimed sigma: what is drawn from must be wider than what is looked for.
    const Eigen::Matrix<double, 12, 6> of_pose = proposal.covariance.leftCols<6>();
    const Matrix6d innovation = of_pose.topRows<6>() + 4.0 * *detected.covariance;
    const Eigen::Matrix<double, 12, 6> gain = of_pose * innovation.inverse();
    proposal.mean = moved(proposal.mean, gain * (proposal.mean.pose.inverse() * *detected.pose).log());
    proposal.covariance -= gain * of_pose.transpose();
    return proposal;
  }

  MotionBelief weigh_in_stages(const MotionBelief& prior, MotionBelief proposal) {
    double power = 0.0;
    for (int stage = 0; stage < 40 && power < 0.5; ++stage) {
      std::vector<double> log_weights = draw(proposal);
      likelihood_.evaluate(light_, particles_, parallel_for(1), &scores_);
      for (std::size_t i = 0; i < kParticles; ++i)
        log_weights[i] += scores_.log_likelihoods[i] - 0.5 * std::pow(distance(prior, particles_[i]), 2);
      const auto weights = [&](double exponent) {
        std::vector<double> scaled = log_weights;
        for (double& value : scaled) value *= exponent;
        return normalized_weights(scaled);
      };
      power = 1.0;
      for (double step = 0.5; step > 1e-4; step *= 0.5)  // bisection; all at 1 are alive at power 0
        power += effective_size(weights(power)) < 0.1 * kParticles ? -step : (power < 1.0 ? step : 0.0);
      proposal = fitted(proposal.mean, weights(power));
    }
    return proposal;
  }

  /// Returns -log of the density of each, but for a constant.
  std::vector<double> draw(const MotionBelief& belief) {
    constexpr int kFreedom = 6;
    const Matrix12d root = belief.covariance.llt().matrixL();
    std::vector<double> minus_log_density(kParticles);
    for (std::size_t i = 0; i < kParticles; ++i) {
      double chi_squared = 0.0;
      for (int k = 0; k < kFreedom; ++k) chi_squared += std::pow(random_.normal(), 2);
      const Vector12d normal = Vector12d::NullaryExpr([&] { return random_.normal(); });
      const Vector12d student = normal * std::sqrt(kFreedom / chi_squared);
      particles_[i] = moved(belief.mean, root * student);
      minus_log_density[i] = 0.5 * (kFreedom + 12) * std::log1p(student.squaredNorm() / kFreedom);
    }
    return minus_log_density;
  }

  MotionBelief fitted(const MotionState& about, const std::vector<double>& weights) const {
    Vector12d mean = Vector12d::Zero();
    Matrix12d second = 1e-12 * Matrix12d::Identity();
    for (std::size_t i = 0; i < kParticles; ++i) {
      const Vector12d step = difference(about, particles_[i]);
      mean += weights[i] * step;
      second += weights[i] * step * step.transpose();
    }
    return {moved(about, mean), second - mean * mean.transpose()};
  }

  static constexpr std::size_t kParticles = 300;
  Camera camera_;
  JointLikelihood likelihood_;
  Localizer localizer_;
  PhotometricFrame light_;
  std::vector<MotionState> particles_ = std::vector<MotionState>(kParticles);
  JointScores scores_;
  std::optional<MotionBelief> belief_;
  Timestamp last_;
  RandomStream random_{1};  // seeded: the same film gives the same poses
};

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s RECORDING    (a folder that `apriltrack simulate` wrote)\n", argv[0]);
    return 2;
  }
  const std::string folder = argv[1];
  const CornerScene scene{read_cameras(folder + "/camera.yaml").cameras.front(),
                          read_tag_map(folder + "/map.yaml")};
  const Trajectory truth = read_trajectory(folder + "/truth.tum");
  ParticleFilter filter(scene.camera, scene.map);
  BlurTracker tracker(scene.camera, scene.map);
  Trajectory of_filter, of_tracker;
  const auto source = open_source(folder);
  while (const auto image = source->next()) {
    if (!image->is_readable()) continue;
    if (const MotionBelief* belief = filter.track(image->frame()))
      of_filter.push_back({image->timestamp, belief->mean.pose});
    if (const TrackResult result = tracker.track(image->frame()); result.pose)
      of_tracker.push_back({image->timestamp, *result.pose});
  }
  double kept = 0.0;
  for (const auto& [name, estimate] :
       {std::pair{"BlurTracker", &of_tracker}, {"particle filter", &of_filter}}) {
    const ErrorSummary errors = evaluate_trajectory(truth, *estimate, &scene, {}).overall;
    kept = errors.success_5px.value_or(0.0);
    std::printf("%s: %.1f %% of %d frames within 5 px; median %.2f mm, %.3f px\n", name, 100.0 * kept,
                errors.frames, 1e3 * errors.position_median_m.value_or(NAN), errors.median_px.value_or(NAN));
  }
  return kept >= 0.95 ? 0 : 1;
} catch (const Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return error.kind() == ErrorKind::kNoResult ? 1 : 2;
}
