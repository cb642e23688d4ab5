#include "blur_covariance.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>
#include <cmath>
#include <vector>

#include "apriltrack/geometry/rotation.h"
#include "apriltrack/tags/tag_corners.h"
#include "support/numeric_jacobian.h"
#include "tag_picture.h"

namespace apriltrack {
namespace {

using test::TagMotion;
using test::TagPicture;

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
    fit_.tags = {{.tag_index = 1, .correlation = std::sqrt(1.0 - 0.008), .path_px = 12.0},
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
  /// J' J of a tag's corners, by central differences.
  Matrix6d of_one_px(std::size_t index) const {
    const Eigen::MatrixXd J =
        test::numeric_jacobian([&](const Eigen::VectorXd& xi) { return pixels(index, xi); }, 6);
    return J.transpose() * J;
  }
  /// J' J / s^2 of equation (10).
  Matrix6d shared_information(std::size_t index, double path_px, double factor) const {
    const double sigma_px = std::hypot(0.006, factor * std::hypot(0.08, 0.003 * path_px));
    return of_one_px(index) / (sigma_px * sigma_px);
  }
  /// What the information alone says, and what these corners add.
  Matrix12d expected(const Matrix6d& shared) const {
    Matrix12d covariance = fit_.information.fullPivLu().inverse();
    covariance.topLeftCorner<6, 6>() += shared.fullPivLu().inverse();
    return covariance;
  }

  /// Of (10), where what is unexplained is twice the usual 0.004, and half.
  const double kOfTwice = std::pow(2.0, 0.75) * 4.0 / 4.02, kOfHalf = std::pow(0.5, 0.75) * 0.25 / 0.27;
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
                    expected(shared_information(1, 12.0, kOfTwice) + shared_information(0, 3.0, kOfHalf)));
}

TEST_P(HandMadeFit, SharesNothingWithTagsThatAreNotExplained) {
  fit_.tags[0].correlation = 0.84;
  expect_covariance(fit_covariance(world_, fit_), expected(shared_information(0, 3.0, kOfHalf)));
  fit_.tags[1].correlation = 0.84;  // none is: all of them
  constexpr double kMost = 12.0;
  expect_covariance(fit_covariance(world_, fit_),
                    expected(shared_information(1, 12.0, kMost) + shared_information(0, 3.0, kMost)));
}

/// Half of the share that is unexplained, of its size; none of it up to 3 %, all of it from 6 % on.
TEST_P(HandMadeFit, LetsWhatMayCoverALoneTagMoveItsCornersByAShareOfItsSize) {
  const Eigen::Vector3d centre =
      camera_from_map(fit_.state.pose, GetParam()) * map().tags[1].T_map_tag.translation();
  const double size_px = 195.0 * 0.14 / centre.norm();
  const auto cover = [&](double unexplained) {
    fit_.tags[0].correlation = std::sqrt(1.0 - unexplained);
    return cover_covariance(world_, fit_);
  };
  const auto expect_sigma_px = [&](const Matrix6d& covariance, double sigma_px) {
    const Matrix6d truth = sigma_px * sigma_px * of_one_px(1).fullPivLu().inverse();
    EXPECT_LT((covariance - truth).norm(), 1e-4 * truth.norm());
  };
  for (TagEvidence& tag : fit_.tags) tag.num_pixels = 120, tag.area_px = 5000.0;
  const TagEvidence other = fit_.tags.back();
  fit_.tags.pop_back();
  EXPECT_EQ(cover(0.0299), Matrix6d::Zero());
  expect_sigma_px(cover(0.045), 0.5 * 0.0225 * size_px);
  expect_sigma_px(cover(0.2), 0.1 * size_px);
  fit_.tags.push_back(other);  // another confirms it: by as many pixels wholly, by half as many by half
  EXPECT_EQ(cover(0.2), Matrix6d::Zero());
  fit_.tags.back().num_pixels /= 2;
  expect_sigma_px(cover(0.2), 0.05 * size_px);
  fit_.tags.clear();
  EXPECT_EQ(cover_covariance(world_, fit_), Matrix6d::Zero());
}

TEST_P(HandMadeFit, LeavesSomethingToTagsThatAreExplainedWholly) {
  for (TagEvidence& tag : fit_.tags) tag.correlation = 1.0;
  constexpr double kLeast = 0.0;  // but for the floor
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

/// The pose's squared error in standard deviations, over its six degrees of freedom.
double normalised_error(const Pose& truth, const Pose& found, const Matrix12d& covariance) {
  const Vector6d off = (truth.inverse() * found).log();
  const Matrix6d of_pose = covariance.topLeftCorner<6, 6>();
  return off.dot(of_pose.ldlt().solve(off)) / 6.0;
}

/// A tag of 40 to 110 px that goes up to 25 px, before a camera whose lens blurs from 0.2 to 0.9 px and whose
/// light is bent by a gamma of 0.85 to 1.15, of which the tracker is told nothing.
TagPicture any_picture(std::uint64_t run) {
  RandomStream random(8, run, 0);
  const double depth_m = random.uniform(0.28, 0.75);
  const double speed_px = random.uniform(0.0, 20.0), heading_rad = random.uniform(0.0, 6.28);
  TagMotion moves;
  moves.position_m << random.uniform(-0.02, 0.02), random.uniform(-0.02, 0.02), depth_m;
  moves.velocity_m_per_s = speed_px / TagPicture::kExposure_s * depth_m / TagPicture::kFocal_px *
                           Eigen::Vector3d(std::cos(heading_rad), std::sin(heading_rad), 0.3);
  moves.yaw_pitch_roll_rad << random.uniform(-3.0, 3.0), random.uniform(0.2, 0.6), random.uniform(-0.6, 0.6);
  moves.yaw_rate_rad_per_s = random.uniform(-4.0, 4.0);
  return TagPicture(moves,
                    {.lens_blur_sigma_px = random.uniform(0.2, 0.9), .gamma = random.uniform(0.85, 1.15)});
}

/// About the truth, not about a mean: what the model misses differs from picture to picture. Of the pose: the
/// velocity's covariance is that of the pixels' noise, and a lens that blurs more than is assumed looks like
/// a longer path.
TEST(FitCovariance, IsHonestAboutTheTruthWhereLensAndResponseAreNotAsAssumed) {
  constexpr double kNoise = 0.01;
  constexpr std::uint64_t kNumRuns = 60;
  double mean = 0.0;
  for (std::uint64_t run = 0; run < kNumRuns; ++run) {
    const TagPicture picture = any_picture(run);
    PhotometricWorld world = picture.world();
    RandomStream random(9, run);
    const MotionBelief prior = prior_about(picture.truth, random);
    const MotionFit fit = fit_motion(world, picture.noisy_frame(kNoise, run), picture.truth, prior, {});
    ASSERT_EQ(fit.tags.size(), 1U);
    mean += normalised_error(picture.truth.pose, fit.state.pose, fit_covariance(world, fit)) / kNumRuns;
  }
  EXPECT_GT(mean, 0.6);
  EXPECT_LT(mean, 1.3);
}

}  // namespace
}  // namespace apriltrack
