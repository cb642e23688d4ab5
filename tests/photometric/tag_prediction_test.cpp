#include "tag_prediction.h"

#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "apriltrack/base/random.h"
#include "apriltrack/geometry/rotation.h"
#include "apriltrack/photometric/motion_fit.h"
#include "support/numeric_jacobian.h"
#include "support/pose_matchers.h"
#include "tag_film.h"
#include "tag_photometry.h"
#include "tag_pixels.h"

namespace apriltrack {
namespace {

using test::TagFilm;
constexpr double kExposure_s = TagFilm::kExposure_s;

/// A tag that moves and turns steadily, seen through a lens: 20 px during the exposure, of a tag of 95 px.
const TagFilm& moving_tag() {
  static const TagFilm film = [] {
    Motion motion;
    motion.T_end = {rotation_exp({0.5, 0.2, 0.1}), Eigen::Vector3d::Zero()};
    motion.position_m[0].rate_per_s = 1.2;
    motion.position_m[1].rate_per_s = -0.7;
    motion.position_m[2] = {.offset = 0.62, .rate_per_s = 0.8, .waves = {}, .bursts = {}};
    motion.yaw_rad.rate_per_s = 2.5;
    return TagFilm(CameraModel({400.0, 405.0, 155.0, 122.0}, RadtanDistortion({-0.12, 0.03, 1e-3, -5e-4})),
                   motion);
  }();
  return film;
}

TEST(TagPrediction, ExplainsARenderedPictureOnEveryLevel) {
  const TagFilm& film = moving_tag();
  PhotometricWorld world = film.world();
  for (int level = 0; level < PhotometricWorld::kNumLevels; ++level) {
    ViewPath path(film.truth, kExposure_s, world.mode);
    const TagPrediction prediction(world, world.tags[0], path, level);
    ASSERT_TRUE(prediction.is_visible());
    EXPECT_GT(prediction.path_px(), 15.0);
    PredictedPixels predicted;
    TagPixels pixels;
    select_pixels(world, film.frame.light, prediction,
                  swept_area(world, film.frame.light[static_cast<std::size_t>(level)], prediction,
                             world.tags[0], level),
                  level, 700, &pixels, &predicted);
    ASSERT_GT(pixels.count, 300U);
    std::vector<float> scratch;
    const TagMisfit misfit = measure_misfit(pixels, predicted, 0.0, &scratch);
    // The ends of the path count, where mostly the wall is seen, which is not of one colour.
    EXPECT_GT(misfit.correlation, 0.99) << "level " << level;
    // Where only the way is sought, instants are farther apart.
    EXPECT_LT(misfit.residual_scale, (level == 0 ? 0.023 : 0.03) * misfit.colours.gain) << "level " << level;
  }
}

TEST(TagPrediction, NoOtherMotionExplainsItAsWell) {
  const TagFilm& film = moving_tag();
  PhotometricWorld world = film.world();
  const auto cost = [&](const MotionState& state) {
    return -log_likelihood(weigh_evidence(world, film.frame, state));
  };
  const double at_truth = cost(film.truth);
  const double by_1_px_m = 0.62 / 400.0;
  Vector12d steps = Vector12d::Constant(by_1_px_m);
  steps[2] = 10.0 * by_1_px_m;  // a pixel and a half of its size
  steps.segment<3>(3).setConstant(0.03);
  steps.segment<6>(6) = steps.head<6>() * (8.0 / kExposure_s);  // 8 px of blur
  for (int i = 0; i < 12; ++i) {
    for (const double sign : {-1.0, 1.0})
      EXPECT_GT(cost(moved(film.truth, sign * steps[i] * Vector12d::Unit(i))), at_truth + 2.0) << i;
  }
}

/// Light and presence of every pixel under a LEFT perturbation of the view and of its rate, as the Jacobians
/// are defined: view(t) = exp(pose + t rate) view_0(t).
class Perturbed {
 public:
  explicit Perturbed(const TagFilm& film) : world_(film.world()), truth_(film.truth) {}

  /// The same instants and texture under another view cannot be asked for: this is the definition, point by
  /// point, of the exposure integral over the pattern's blurred picture.
  Eigen::VectorXd predict(const std::vector<Eigen::Vector2f>& rays, const Eigen::VectorXd& step, int count,
                          const PatternTexture& texture) const {
    Eigen::VectorXd result = Eigen::VectorXd::Zero(2 * static_cast<Eigen::Index>(rays.size()));
    const double half = 0.5 * world_.tags[0].tag.size_m;
    for (int m = 0; m < count; ++m) {
      const double t = kExposure_s * ((m + 0.5) / count - 0.5);
      const Pose view =
          Pose::exp(Vector6d(step.head<6>() + t * step.tail<6>())) * pose_after(truth_, count == 1 ? 0.0 : t);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        // Where the ray through the pixel meets the plane of the tag.
        const Eigen::Vector3d ray(rays[i].x(), rays[i].y(), 1.0);
        const Eigen::Vector3d normal = view.rotation() * Eigen::Vector3d::UnitZ();
        const Eigen::Vector3d meets = ray * (normal.dot(view.translation()) / normal.dot(ray));
        const Eigen::Vector3d in_plane = view.inverse() * meets / half;
        const PatternSample sample =
            texture.sample(static_cast<float>(in_plane.x()), static_cast<float>(in_plane.y()));
        result[2 * static_cast<Eigen::Index>(i)] += sample.light / count;
        result[2 * static_cast<Eigen::Index>(i) + 1] += sample.presence / count;
      }
    }
    return result;
  }

 private:
  PhotometricWorld world_;
  MotionState truth_;
};

TEST(TagPrediction, JacobianIsTheNumericOne) {
  const TagFilm& film = moving_tag();
  PhotometricWorld world = film.world();
  ViewPath path(film.truth, kExposure_s, world.mode);
  const TagPrediction prediction(world, world.tags[0], path, 0);
  PredictedPixels predicted;
  TagPixels pixels;
  select_pixels(world, film.frame.light, prediction,
                swept_area(world, film.frame.light[0], prediction, world.tags[0], 0), 0, 300, &pixels,
                &predicted);
  std::vector<Eigen::Vector2f> rays;
  for (std::size_t i = 0; i < pixels.count; ++i) rays.emplace_back(pixels.ray_x[i], pixels.ray_y[i]);
  ASSERT_GT(rays.size(), 150U);
  Eigen::MatrixXd analytic(2 * static_cast<Eigen::Index>(rays.size()), 12);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    PixelJacobian jacobian;
    prediction.predict(rays[i], jacobian);
    const auto row = 2 * static_cast<Eigen::Index>(i);
    for (Eigen::Index k = 0; k < 6; ++k) {
      const auto index = static_cast<std::size_t>(k);
      analytic(row, k) = jacobian.light_by_pose[index];
      analytic(row, k + 6) = jacobian.light_by_rate[index];
      analytic(row + 1, k) = jacobian.presence_by_pose[index];
      analytic(row + 1, k + 6) = jacobian.presence_by_rate[index];
    }
  }
  const Perturbed perturbed(film);
  const PatternTexture& texture = prediction.texture();
  const auto count = static_cast<int>(prediction.num_instants());
  ASSERT_GT(count, 4);
  for (Eigen::Index k = 0; k < 12; ++k) {
    // A hundredth of a pixel of the fastest corner: within a texel, above the rounding of floats.
    const double step = (k % 6 < 3 ? 2e-5 : 3e-5) / (k < 6 ? 1.0 : 0.25 * kExposure_s);
    const Eigen::VectorXd delta = step * Eigen::VectorXd::Unit(12, k);
    const Eigen::VectorXd numeric =
        (perturbed.predict(rays, delta, count, texture) - perturbed.predict(rays, -delta, count, texture)) /
        (2.0 * step);
    ASSERT_GT(numeric.norm(), 0.0);
    EXPECT_LT((numeric - analytic.col(k)).norm(), 0.05 * numeric.norm()) << "parameter " << k;
  }
}

TEST(FitMotion, FindsPoseAndVelocityFromWhereThePredictionIs) {
  const TagFilm& film = moving_tag();
  // The camera in the tag's frame: T^-1 exp(-adjoint(T) v t) is the inverse of T exp(v t).
  MotionState seen_from_tag;
  seen_from_tag.pose = film.truth.pose.inverse();
  seen_from_tag.velocity = -(film.truth.pose.adjoint() * film.truth.velocity);
  RandomStream random(1);
  int num_found_joint = 0, num_found_ego = 0;
  for (int run = 0; run < 8; ++run) {
    for (const TrackMode mode : {TrackMode::kJoint, TrackMode::kEgo}) {
      PhotometricWorld world = film.world(mode);
      const MotionState truth = mode == TrackMode::kJoint ? film.truth : seen_from_tag;
      Vector12d sigma = Vector12d::Constant(0.004);  // 3 px of a tag with cells of 10 px
      sigma.segment<3>(3).setConstant(mode == TrackMode::kJoint ? 0.03 : 0.006);
      sigma.segment<3>(6).setConstant(0.25);  // 3 px of blur
      sigma.segment<3>(9).setConstant(1.0);
      Vector12d off;
      for (Eigen::Index i = 0; i < 12; ++i) off[i] = sigma[i] * random.normal();
      MotionBelief prior;
      prior.mean = moved(truth, off);
      prior.covariance.diagonal() = sigma.cwiseAbs2();
      const MotionFit fit = fit_motion(world, film.frame, prior.mean, prior, {});
      ASSERT_EQ(fit.tags.size(), 1U);
      if (fit.tags[0].correlation < 0.995) continue;  // another minimum, and it shows
      (mode == TrackMode::kJoint ? num_found_joint : num_found_ego) += 1;
      double error_px = 0.0;
      for (const Eigen::Vector3d& corner : tag_corners(0.16)) {
        const Eigen::Vector3d found = camera_from_map(fit.state.pose, mode) * corner;
        const Eigen::Vector3d expected = film.truth.pose * corner;
        error_px += 0.25 * (*world.model.project(found) - *world.model.project(expected)).norm();
      }
      EXPECT_LT(error_px, 0.2) << "run " << run;  // of 20 px of blur
      // Per number; the picture is free of noise, and what the model leaves out is not in the information.
      const Vector12d wrong = difference(fit.state, truth);
      EXPECT_LT(wrong.dot(fit.information * wrong) / 12.0, 10.0) << "run " << run << "\n"
                                                                 << wrong.transpose();
    }
  }
  EXPECT_EQ(num_found_joint, 8);
  // A camera's turn and its way sideways look alike: two of these end elsewhere.
  EXPECT_GE(num_found_ego, 6);
}

TEST(FitMotion, DetectedCornersHoldWhatThePixelsDoNotShow) {
  // All is dark, but corners are told: the pose that they determine comes out.
  const TagFilm& film = moving_tag();
  PhotometricWorld world = film.world();
  PhotometricFrame dark;
  dark.light = light_pyramid(Image<float>(320, 240), PhotometricWorld::kNumLevels);
  dark.exposure_s = kExposure_s;
  std::vector<CornerObservation> corners;
  for (const Eigen::Vector3d& corner : tag_corners(0.16))
    corners.push_back({corner, *world.model.project(film.truth.pose * corner), 0.1});
  MotionState start = film.truth;
  start.pose = film.truth.pose * Pose::exp((Vector6d() << 0.01, -0.008, 0.02, 0.03, -0.02, 0.04).finished());
  const MotionFit fit = fit_motion(world, dark, start, std::nullopt, corners);
  EXPECT_THAT(fit.state.pose, test::PoseNear(film.truth.pose, 1e-4, 1e-3));
}

}  // namespace
}  // namespace apriltrack
