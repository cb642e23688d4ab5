#include "blur_covariance.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <vector>

#include "apriltrack/geometry/rotation.h"
#include "apriltrack/tags/tag_corners.h"
#include "support/numeric_jacobian.h"
#include "tag_picture.h"

namespace apriltrack {
namespace {

/// Two tags before a pinhole camera, and a fit of them whose information is any positive matrix.
class HandMadeFit : public ::testing::TestWithParam<TrackMode> {
 protected:
  HandMadeFit() : world_(camera(), map(), GetParam(), 160, 120) {
    const Pose T_camera_map(rotation_exp({0.3, -0.2, 0.1}), {0.05, -0.02, 0.8});
    fit_.state.pose = GetParam() == TrackMode::kEgo ? T_camera_map.inverse() : T_camera_map;
    RandomStream random(21);
    Matrix12d root;
    for (double& value : root.reshaped()) value = random.normal();
    fit_.information = 50.0 * (root * root.transpose() + Matrix12d::Identity());
    fit_.tags = {{.tag_index = 1, .correlation = std::sqrt(1.0 - 0.006), .path_px = 12.0},
                 {.tag_index = 0, .correlation = std::sqrt(1.0 - 0.002), .path_px = 3.0}};
  }

  static Camera camera() { return {.model = CameraModel({200.0, 190.0, 79.5, 59.5}, NoDistortion{})}; }
  static TagMap map() {
    TagMap map;
    for (const int id : {4, 2}) {
      MapTag tag;
      tag.key = {"tag36h11", id};
      tag.size_m = 0.1 + 0.02 * id;
      tag.T_map_tag = {rotation_exp({0.0, 0.2 * id, 0.1}), {0.1 * (id - 3), 0.02 * id, 0.1}};
      map.tags.push_back(tag);
    }
    return map;
  }

  /// The corners of tag `index` in the image, where the pose is perturbed on its right; by hand.
  Eigen::VectorXd pixels(std::size_t index, const Eigen::VectorXd& xi) const {
    const Pose pose = fit_.state.pose * Pose::exp(Vector6d(xi));
    const Pose T_camera_map = GetParam() == TrackMode::kEgo ? pose.inverse() : pose;
    const MapTag tag = map().tags[index];
    Eigen::VectorXd result(8);
    Eigen::Index row = 0;
    for (const Eigen::Vector3d& corner : tag_corners(tag.size_m)) {
      const Eigen::Vector3d p = T_camera_map * (tag.T_map_tag * corner);
      result.segment<2>(row) << 200.0 * p.x() / p.z(), 190.0 * p.y() / p.z();
      row += 2;
    }
    return result;
  }
  /// J' J / s^2 of equation (10), by central differences.
  Matrix6d shared_information(std::size_t index, double path_px, double unexplained_over_usual) const {
    const Eigen::MatrixXd J =
        test::numeric_jacobian([&](const Eigen::VectorXd& xi) { return pixels(index, xi); }, 6);
    const double variance_px2 = unexplained_over_usual * (0.03 * 0.03 + 0.006 * 0.006 * path_px * path_px);
    return J.transpose() * J / variance_px2;
  }
  /// What the information alone says, and what these corners add.
  Matrix12d expected(const Matrix6d& shared) const {
    Matrix12d covariance = fit_.information.fullPivLu().inverse();
    covariance.topLeftCorner<6, 6>() += shared.fullPivLu().inverse();
    return covariance;
  }

  PhotometricWorld world_;
  MotionFit fit_;
};

INSTANTIATE_TEST_SUITE_P(Modes, HandMadeFit, ::testing::Values(TrackMode::kEgo, TrackMode::kJoint),
                         [](const auto& mode) { return mode.param == TrackMode::kEgo ? "Ego" : "Joint"; });

/// Relative: its entries are far apart.
void expect_covariance(const Matrix12d& covariance, const Matrix12d& truth) {
  const Vector12d sigma = truth.diagonal().cwiseSqrt();
  const Matrix12d relative = ((covariance - truth).array() / (sigma * sigma.transpose()).array()).matrix();
  EXPECT_LT(relative.cwiseAbs().maxCoeff(), 1e-5) << covariance << "\n\n" << truth;
  EXPECT_EQ(covariance, Matrix12d(covariance.transpose()));
}

TEST_P(HandMadeFit, AddsTheSharedErrorsOfTheTagsToTheInverseOfItsInformation) {
  expect_covariance(fit_covariance(world_, fit_),
                    expected(shared_information(1, 12.0, 1.5) + shared_information(0, 3.0, 0.5)));
}

TEST_P(HandMadeFit, SharesNothingWithTagsThatAreNotExplained) {
  fit_.tags[0].correlation = 0.84;
  expect_covariance(fit_covariance(world_, fit_), expected(shared_information(0, 3.0, 0.5)));
  fit_.tags[1].correlation = 0.84;  // none is: all of them
  constexpr double kMost = 10.0;
  expect_covariance(fit_covariance(world_, fit_),
                    expected(shared_information(1, 12.0, kMost) + shared_information(0, 3.0, kMost)));
}

TEST_P(HandMadeFit, LeavesSomethingToTagsThatAreExplainedWholly) {
  for (TagEvidence& tag : fit_.tags) tag.correlation = 1.0;
  constexpr double kLeast = 0.02;
  expect_covariance(fit_covariance(world_, fit_),
                    expected(shared_information(1, 12.0, kLeast) + shared_information(0, 3.0, kLeast)));
}

TEST_P(HandMadeFit, IsTheInverseOfTheInformationWhereNoTagIsSeen) {
  fit_.tags.clear();
  expect_covariance(fit_covariance(world_, fit_), fit_.information.fullPivLu().inverse());
}

/// What is known before the picture: about where the tag is, and how it moves.
Matrix12d prior_covariance() {
  Vector12d sigma;
  sigma << Eigen::Vector3d::Constant(0.01), Eigen::Vector3d::Constant(0.05), Eigen::Vector3d::Constant(0.2),
      Eigen::Vector3d::Constant(1.0);
  return sigma.cwiseAbs2().asDiagonal();
}
MotionBelief prior_about(const MotionState& truth, RandomStream& random) {
  Vector12d step;
  for (double& value : step) value = random.normal();
  return {moved(truth, prior_covariance().cwiseSqrt() * step), prior_covariance()};
}

/// How far a tag is led off whose corners are off by s each, (10): least squares over the four of them.
Vector6d shared_error(const test::TagPicture& picture, const TagEvidence& tag, RandomStream& random) {
  const auto corners_at = [&](const Eigen::VectorXd& xi) {
    Eigen::VectorXd pixels(8);
    Eigen::Index row = 0;
    for (const Eigen::Vector3d& corner : tag_corners(test::TagPicture::kSize_m)) {
      const Eigen::Vector3d p = picture.truth.pose * Pose::exp(Vector6d(xi)) * corner;
      pixels.segment<2>(row) = test::TagPicture::kFocal_px * p.head<2>() / p.z();
      row += 2;
    }
    return pixels;
  };
  const double unexplained = 1.0 - tag.clean_correlation() * tag.clean_correlation();
  const double sigma_px =
      std::hypot(0.03, 0.006 * tag.path_px) * std::sqrt(std::clamp(unexplained / 0.004, 0.02, 10.0));
  Eigen::VectorXd off_px(8);
  for (double& value : off_px) value = sigma_px * random.normal();
  return test::numeric_jacobian(corners_at, 6).colPivHouseholderQr().solve(off_px);
}

/// About their own mean: what the model misses is the same in every run.
TEST(FitCovariance, IsThatOfTheScatterOverNoisePriorAndSharedErrors) {
  constexpr double kNoise = 0.03;  // a tenth of the contrast
  constexpr std::uint64_t kNumRuns = 60;
  const test::TagPicture picture;
  PhotometricWorld world = picture.world();
  std::vector<Vector12d> errors;
  std::vector<Matrix12d> covariances;
  for (std::uint64_t run = 0; run < kNumRuns; ++run) {
    RandomStream random(8, run);
    const MotionBelief prior = prior_about(picture.truth, random);
    const MotionFit fit = fit_motion(world, picture.noisy_frame(kNoise, run), picture.truth, prior, {});
    ASSERT_EQ(fit.tags.size(), 1U);
    covariances.push_back(fit_covariance(world, fit));
    errors.push_back(difference(picture.truth, fit.state));
    errors.back().head<6>() += shared_error(picture, fit.tags[0], random);
  }
  Vector12d mean = Vector12d::Zero();
  for (const Vector12d& error : errors) mean += error / kNumRuns;
  double of_all = 0.0, of_pose = 0.0;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const Vector12d off = errors[i] - mean;
    const Matrix6d pose_covariance = covariances[i].topLeftCorner<6, 6>();
    of_all += off.dot(covariances[i].ldlt().solve(off)) / 12.0 / (kNumRuns - 1.0);
    of_pose += off.head<6>().dot(pose_covariance.ldlt().solve(off.head<6>())) / 6.0 / (kNumRuns - 1.0);
  }
  // Chi-squares over their degrees of freedom: the mean of 60 is 1, give or take 0.05 (all) and 0.07 (pose).
  EXPECT_NEAR(of_all, 1.0, 0.25);
  EXPECT_NEAR(of_pose, 1.0, 0.25);
}

}  // namespace
}  // namespace apriltrack
