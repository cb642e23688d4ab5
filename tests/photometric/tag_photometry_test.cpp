#include "tag_photometry.h"

#include <gtest/gtest.h>

#include <vector>

#include "apriltrack/base/random.h"
#include "support/numeric_jacobian.h"
#include "tag_film.h"

namespace apriltrack {
namespace {

using test::TagFilm;

/// A tag that moves by 12 px, tilted, and a picture of it that is the prediction at the truth, in colours,
/// with noise of 0.001.
class TagCost {
 public:
  static constexpr double kNoise = 1e-3;
  static constexpr TagColours kColours = {.gain = 0.6, .black = 0.1, .background = 0.3};

  TagCost() : film_(lens(), motion()), world_(film_.world()) {
    const TagPrediction prediction = prediction_of(film_.truth);
    const auto swept = swept_area(world_, film_.frame.light[0], prediction, world_.tags[0], 0);
    PredictedPixels predicted;
    select_pixels(world_, film_.frame.light, prediction, swept, 0, 700, &pixels_, &predicted);
    RandomStream random(1);
    for (std::size_t i = 0; i < pixels_.count; ++i) {
      const PixelPrediction seen = prediction.predict({pixels_.ray_x[i], pixels_.ray_y[i]});
      pixels_.image[i] =
          static_cast<float>(kColours.gain * seen.light + kColours.black * seen.presence +
                             kColours.background * (1.0 - seen.presence) + kNoise * random.normal());
    }
  }

  std::size_t num_pixels() const { return pixels_.count; }

  /// The path exp(pose + t rate) T(t), to the first order in the step and the second in t: what the rate's
  /// turn does to the path so far is an acceleration.
  MotionState perturbed(const Eigen::VectorXd& step) const {
    MotionState state = film_.truth;
    const Vector6d rate = film_.truth.pose.inverse().adjoint() * step.tail<6>();
    state.pose = Pose::exp(step.head<6>()) * film_.truth.pose;
    state.velocity += rate;
    const Eigen::Vector3d turn = rate.tail<3>();
    state.acceleration.head<3>() += 2.0 * turn.cross(film_.truth.velocity.head<3>());
    state.acceleration.tail<3>() += turn.cross(film_.truth.velocity.tail<3>());
    return state;
  }

  double cost(const Eigen::VectorXd& step, double scale) {
    return misfit(prediction_of(perturbed(step)), scale).cost;
  }

  TagNormalEquations linearised(const Eigen::VectorXd& step, double scale) {
    const TagPrediction prediction = prediction_of(perturbed(step));
    return linearise(pixels_, prediction, misfit(prediction, scale).colours, scale);
  }

 private:
  static CameraModel lens() {
    return {{400.0, 405.0, 155.0, 122.0}, RadtanDistortion({-0.12, 0.03, 1e-3, -5e-4})};
  }
  static Motion motion() {
    Motion motion;
    motion.T_end = {rotation_exp({0.5, 0.3, 0.1}), Eigen::Vector3d::Zero()};
    motion.position_m[0].rate_per_s = 0.7;
    motion.position_m[1].rate_per_s = -0.5;
    motion.position_m[2].offset = 0.62;
    motion.yaw_rad.rate_per_s = 1.0;
    return motion;
  }
  TagPrediction prediction_of(const MotionState& state) {
    ViewPath path(state, TagFilm::kExposure_s, world_.mode);
    return {world_, world_.tags[0], path, 0};
  }
  TagMisfit misfit(const TagPrediction& prediction, double scale) const {
    PredictedPixels predicted;
    predict(prediction, pixels_, &predicted);
    std::vector<float> scratch;
    return measure_misfit(pixels_, predicted, scale, &scratch);
  }

  TagFilm film_;
  PhotometricWorld world_;
  TagPixels pixels_;
};

/// Steps of the twelve numbers that move the tag's corners by about a pixel.
Eigen::VectorXd steps_of_a_pixel() {
  Eigen::VectorXd steps(12);
  steps << 0.0015, 0.0015, 0.012, 0.0025, 0.0025, 0.02, Eigen::VectorXd::Zero(6);
  steps.tail<6>() = steps.head<6>() * (3.0 / TagFilm::kExposure_s);  // 3 px of path
  return steps;
}

TEST(LinearisedTag, CurvatureIsThatOfTheCost) {
  // In the sum's own units, J' J is what differences of the cost show where nothing else is left to explain.
  TagCost tag;
  ASSERT_GT(tag.num_pixels(), 300U);
  constexpr double kScale = 0.2;  // so far above the noise and the step that all pixels count alike
  const Eigen::MatrixXd unit = steps_of_a_pixel().asDiagonal();
  const Eigen::MatrixXd H = unit * tag.linearised(Eigen::VectorXd::Zero(12), kScale).H * unit;
  const double at_truth = tag.cost(Eigen::VectorXd::Zero(12), kScale);
  constexpr double kStep = 0.1;
  const auto curvature = [&](const Eigen::VectorXd& direction) {
    const Eigen::VectorXd step = kStep * (unit * direction);
    return (tag.cost(step, kScale) + tag.cost(-step, kScale) - 2.0 * at_truth) / (kStep * kStep);
  };
  Eigen::MatrixXd numeric(12, 12);
  for (int i = 0; i < 12; ++i) {
    for (int k = 0; k < 12; ++k) {
      const Eigen::VectorXd a = Eigen::VectorXd::Unit(12, i), b = Eigen::VectorXd::Unit(12, k);
      numeric(i, k) = 0.25 * (curvature(a + b) - curvature(a - b));
    }
  }
  EXPECT_GT(H.diagonal().minCoeff(), 0.0);
  for (int i = 0; i < 12; ++i) {
    for (int k = 0; k < 12; ++k)
      EXPECT_NEAR(H(i, k), numeric(i, k), 0.05 * std::sqrt(H(i, i) * H(k, k))) << i << " " << k;
  }
}

TEST(LinearisedTag, SlopeIsThatOfTheCostWhereverPixelsStopToCount) {
  TagCost tag;
  RandomStream random(2);
  const Eigen::VectorXd unit = steps_of_a_pixel();
  for (const double scale : {0.2, 0.02}) {  // with the latter most edges are beyond the reach
    for (int run = 0; run < 8; ++run) {
      Eigen::VectorXd off(12);
      for (double& value : off) value = 0.25 * random.normal();
      const Eigen::VectorXd at = unit.cwiseProduct(off);
      const Eigen::VectorXd g = unit.cwiseProduct(tag.linearised(at, scale).g);
      const Eigen::MatrixXd numeric = test::numeric_jacobian(
          [&](const Eigen::VectorXd& step) {
            return Eigen::VectorXd::Constant(1, tag.cost(at + unit.cwiseProduct(step), scale));
          },
          12, 0.02);
      ASSERT_GT(g.norm(), 1.0);
      EXPECT_LT((g - numeric.transpose()).norm(), 0.06 * g.norm()) << scale << "\n"
                                                                   << g.transpose() << "\n"
                                                                   << numeric;
    }
  }
}

}  // namespace
}  // namespace apriltrack
