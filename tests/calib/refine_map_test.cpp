#include "apriltrack/calib/refine_map.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "filmed_room.h"

// Maps refined on rendered pictures, against the scene that they were rendered from.

namespace apriltrack {
namespace {

using test::FilmedRoom;

double rms_m(const TagMap& truth, const TagKey& held, const TagMap& map) {
  double sum = 0.0;
  for (const MapTag& tag : map.tags)
    sum +=
        (tag.T_map_tag.translation() - test::T_origin_tag(truth, held, tag.key).translation()).squaredNorm();
  return std::sqrt(sum / static_cast<double>(map.tags.size()));
}

TEST(RefinedMap, IsNearerToTheTruthThanItsCornersAndClaimsNoMore) {
  const FilmedRoom& filmed = FilmedRoom::once();
  const RefinementResult refined = refine_map(filmed.by_corners, filmed.frames, filmed.rig, {});
  ASSERT_TRUE(refined.is_accepted) << refined.reason;
  const TagKey held = filmed.by_corners.held_tag;
  const double before_m = rms_m(filmed.scene.map, held, filmed.by_corners.map);
  const double after_m = rms_m(filmed.scene.map, held, refined.map);
  EXPECT_LT(after_m, 0.6 * before_m) << before_m;
  EXPECT_LT(refined.held_out_after, refined.held_out_before);
  ASSERT_EQ(refined.lens_blurs.size(), 1U);
  EXPECT_EQ(refined.lens_blurs[0].camera, filmed.rig.cameras[0].name);
  EXPECT_NEAR(refined.lens_blurs[0].sigma_px, 0.5, 0.1);  // the renderer's lens
  EXPECT_EQ(refined.refined.size(), refined.map.tags.size());
  EXPECT_EQ(refined.warnings, filmed.by_corners.warnings);

  double largest = 0.0;
  const double error = test::mean_normalised_error(filmed.scene.map, held, refined.map, &largest);
  EXPECT_GT(error, 0.02) << "claims far less than it knows";  // rendered tags keep no errors: .06
  EXPECT_LT(error, 1.5);
  EXPECT_LT(largest, 4.0);
  EXPECT_TRUE(refined.map.find(held)->covariance->isZero());
}

TEST(RefinedMap, KeepsToConstraintsInTheMeasuredFrame) {
  const FilmedRoom& filmed = FilmedRoom::once();
  CalibrationOptions options;
  for (const std::size_t i : {0U, 4U, 8U, 12U}) {
    const MapTag& tag = filmed.scene.map.tags[i];
    const Eigen::Vector3d p = tag.T_map_tag.translation();
    options.constraints.push_back({.what = PositionConstraint{tag.key, {p.x(), p.y(), p.z()}, 1e-4}});
  }
  const TagSizes sizes(filmed.scene.map.tags.front().size_m);
  CalibrationResult by_corners = calibrate_map(filmed.frames, filmed.rig, sizes, options);
  ConstraintAudit unused;
  unused.title = "of the corners";
  unused.reason = "its tags lie in a line";
  by_corners.constraint_audits.insert(by_corners.constraint_audits.begin() + 1, unused);
  by_corners.findings = {{.kind = CalibrationFinding::Kind::kLoose, .message = "of something else"},
                         {.kind = CalibrationFinding::Kind::kConstraintInDoubt, .message = "by the corners"}};
  const RefinementResult refined = refine_map(by_corners, filmed.frames, filmed.rig, {});
  ASSERT_TRUE(refined.is_accepted) << refined.reason;
  EXPECT_EQ(refined.gauge, by_corners.gauge);
  EXPECT_EQ(refined.warnings, std::vector<std::string>{"of something else"});
  ASSERT_EQ(refined.constraint_audits.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(refined.constraint_audits[i].title, by_corners.constraint_audits[i].title);
    EXPECT_EQ(refined.constraint_audits[i].is_used, i != 1);
  }
  EXPECT_LT(*refined.constraint_audits[0].readings[0].sigma,
            *by_corners.constraint_audits[0].readings[0].sigma)
      << "the pictures predict better than the corners";
  // In the world's frame, the held tag too.
  double sum = 0.0;
  for (const MapTag& tag : refined.map.tags) {
    const Vector6d xi = (tag.T_map_tag.inverse() * filmed.scene.map.find(tag.key)->T_map_tag).log();
    const double error = xi.dot(tag.covariance->ldlt().solve(xi)) / 6.0;
    EXPECT_LT(error, 4.0) << to_string(tag.key);
    sum += error;
  }
  const double mean_error = sum / static_cast<double>(refined.map.tags.size());
  EXPECT_GT(mean_error, 0.02);
  EXPECT_LT(mean_error, 1.5);
  for (const std::size_t i : {0U, 4U, 8U, 12U}) {
    const MapTag& truth = filmed.scene.map.tags[i];
    EXPECT_LT((refined.map.find(truth.key)->T_map_tag.translation() - truth.T_map_tag.translation()).norm(),
              3e-4);
  }
}

TEST(RefinedMap, DoesNotDependOnTheNumberOfThreads) {
  const FilmedRoom& filmed = FilmedRoom::once();
  const RefinementResult one =
      refine_map(filmed.by_corners, filmed.frames, filmed.rig, {.max_moments = 20, .num_threads = 1});
  const RefinementResult three =
      refine_map(filmed.by_corners, filmed.frames, filmed.rig, {.max_moments = 20, .num_threads = 3});
  ASSERT_TRUE(one.is_accepted) << one.reason;
  for (std::size_t i = 0; i < one.map.tags.size(); ++i) {
    EXPECT_EQ(one.map.tags[i].T_map_tag.matrix(), three.map.tags[i].T_map_tag.matrix());
    EXPECT_EQ(*one.map.tags[i].covariance, *three.map.tags[i].covariance);
  }
}

/// Rotations are half a metre's worth of translation, that both may be judged in one number.
double norm_m(const Vector6d& xi) {
  return std::hypot(xi.head<3>().norm(), 0.5 * xi.tail<3>().norm());
}

TEST(RefinedMap, FollowsErrorsOfALensThatWasEstimatedWithIt) {
  // The share of the covariances, against maps refined with the lens moved either way.
  const FilmedRoom& filmed = FilmedRoom::once();
  constexpr double kSigma = 0.001;  // of the focal length
  constexpr double kCenterSigma_px = 0.3;
  CalibrationResult given = filmed.by_corners;
  given.constraints.clear();
  const auto refined_with = [&](double focal_share, double center_px) {
    CalibrationResult moved = given;
    Pinhole pinhole = given.rig.cameras[0].model.pinhole();
    pinhole.fx *= 1.0 + focal_share;
    pinhole.fy *= 1.0 + focal_share;
    pinhole.cx += center_px;
    moved.rig.cameras[0].model = CameraModel(pinhole, given.rig.cameras[0].model.distortion());
    const RefinementResult result = refine_map(moved, filmed.frames, moved.rig, {});
    EXPECT_TRUE(result.is_accepted) << result.reason;
    return result.map;
  };
  const auto by_difference = [&](const TagMap& above, const TagMap& below, const TagKey& key) {
    return Vector6d(0.5 * (below.find(key)->T_map_tag.inverse() * above.find(key)->T_map_tag).log());
  };
  const TagMap longer = refined_with(kSigma, 0.0), shorter = refined_with(-kSigma, 0.0);
  const TagMap right = refined_with(0.0, kCenterSigma_px), left = refined_with(0.0, -kCenterSigma_px);
  const RefinementResult exact = refine_map(given, filmed.frames, given.rig, {});
  ASSERT_TRUE(exact.is_accepted) << exact.reason;

  const std::string& camera = given.rig.cameras[0].name;
  given.corrections = {{camera, "edge offset", "px", 0.0, 0.1},
                       {camera, "focal length", "1", 0.0, kSigma},
                       {camera, "cx", "px", 0.0, kCenterSigma_px}};
  given.corrections_covariance =
      Eigen::Vector3d(0.01, kSigma * kSigma, kCenterSigma_px * kCenterSigma_px).asDiagonal();
  const RefinementResult estimated = refine_map(given, filmed.frames, given.rig, {});
  ASSERT_TRUE(estimated.is_accepted) << estimated.reason;

  double expected2 = 0.0, squared_difference = 0.0;
  for (const MapTag& tag : exact.map.tags) {
    const Vector6d by_focal = by_difference(longer, shorter, tag.key);
    const Vector6d by_center = by_difference(right, left, tag.key);
    const double expected_m = std::hypot(norm_m(by_focal), norm_m(by_center));
    const Matrix6d added = *estimated.map.find(tag.key)->covariance - *tag.covariance;
    const double added_m =
        std::sqrt(added.topLeftCorner<3, 3>().trace() + 0.25 * added.bottomRightCorner<3, 3>().trace());
    expected2 += expected_m * expected_m;
    squared_difference += std::pow(added_m - expected_m, 2);
  }
  const auto num = static_cast<double>(exact.map.tags.size());
  EXPECT_GT(std::sqrt(expected2 / num), 5e-4) << "a case in which it matters";
  EXPECT_LT(std::sqrt(squared_difference / expected2), 0.1);
  // Of the corners' noise, and of errors of corners in pixels, whatever the pictures' own units are.
  EXPECT_EQ(exact.joint.noise_variance, given.evidence.joint.noise_variance);
  EXPECT_TRUE(exact.joint.are_errors_of_corners);
  const double bias_px = exact.joint.bias_sigma;
  EXPECT_GE(bias_px, 0.99 * RefinementOptions{}.picture_bias_px);
  EXPECT_LT(bias_px, 5.0 * RefinementOptions{}.picture_bias_px);
  const TagKey& key = estimated.joint.tags.back();
  const auto row = *estimated.joint.row_of(key);
  EXPECT_LT((estimated.joint.block(row, row) - *estimated.map.find(key)->covariance).norm(),
            1e-9 * estimated.map.find(key)->covariance->norm());
}

TEST(RefinedMap, FollowsPrintsThatMayNotBeAsStated) {
  // The share of the covariances, against maps refined with the sizes of either print moved both ways.
  const FilmedRoom& filmed = FilmedRoom::once();
  constexpr double kLogRatio = 0.002;
  const CalibrationResult& given = filmed.by_corners;
  CalibrationResult doubted = given;
  PrintBatches batches{{}, {}, kLogRatio, 0.0002};
  for (std::size_t i = 0; i < given.map.tags.size(); ++i)
    (i % 2 == 0 ? batches.larger : batches.smaller).push_back(given.map.tags[i].key);
  doubted.print_batches = batches;
  const auto refined_with = [&](std::size_t print, double log_size) {
    CalibrationResult moved = given;
    for (std::size_t i = print; i < moved.map.tags.size(); i += 2)
      moved.map.tags[i].size_m *= std::exp(log_size);
    const RefinementResult result = refine_map(moved, filmed.frames, moved.rig, {});
    EXPECT_TRUE(result.is_accepted) << result.reason;
    return result.map;
  };
  const std::array<TagMap, 2> larger = {refined_with(0, kLogRatio), refined_with(1, kLogRatio)};
  const std::array<TagMap, 2> smaller = {refined_with(0, -kLogRatio), refined_with(1, -kLogRatio)};
  const RefinementResult exact = refine_map(given, filmed.frames, given.rig, {});
  const RefinementResult result = refine_map(doubted, filmed.frames, given.rig, {});
  ASSERT_TRUE(exact.is_accepted && result.is_accepted) << exact.reason << result.reason;

  double expected2 = 0.0, squared_difference = 0.0;
  for (const MapTag& tag : exact.map.tags) {
    double of_tag2 = 0.0;
    for (std::size_t print = 0; print < 2; ++print) {
      const Vector6d by_size =
          0.5 *
          (smaller[print].find(tag.key)->T_map_tag.inverse() * larger[print].find(tag.key)->T_map_tag).log();
      of_tag2 += norm_m(by_size) * norm_m(by_size);
    }
    const Matrix6d added = *result.map.find(tag.key)->covariance - *tag.covariance;
    const double added_m =
        std::sqrt(added.topLeftCorner<3, 3>().trace() + 0.25 * added.bottomRightCorner<3, 3>().trace());
    expected2 += of_tag2;
    squared_difference += std::pow(added_m - std::sqrt(of_tag2), 2);
  }
  EXPECT_GT(std::sqrt(expected2 / static_cast<double>(exact.map.tags.size())), 1e-3);
  // A size is counted by the rim of a tag, and pictures weigh its inside as well: .12.
  EXPECT_LT(std::sqrt(squared_difference / expected2), 0.2);
}

TEST(RefinedMap, FlagsTagsByTheirPictures) {
  const FilmedRoom& filmed = FilmedRoom::once();
  CalibrationResult by_corners = filmed.by_corners;
  by_corners.map.tags[3].statistics->flags = {"weak", "outliers"};
  by_corners.map.tags[4].statistics->views = 4;
  const RefinementResult refined = refine_map(by_corners, filmed.frames, filmed.rig, {.max_moments = 20});
  ASSERT_TRUE(refined.is_accepted) << refined.reason;
  EXPECT_EQ(refined.map.tags[3].statistics->flags, std::vector<std::string>{"outliers"});
  EXPECT_EQ(refined.map.tags[4].statistics->flags, std::vector<std::string>{"weak"});
}

TEST(RefinedMap, TellsTheBlurOfLensesThatTookPart) {
  const FilmedRoom& filmed = FilmedRoom::once();
  CalibrationResult by_corners = filmed.by_corners;
  Camera idle = by_corners.rig.cameras[0];
  idle.name = "idle";
  by_corners.rig.cameras.insert(by_corners.rig.cameras.begin(), idle);
  by_corners.rig.cameras[1].T_this_previous = Pose();
  const RefinementResult refined = refine_map(by_corners, filmed.frames, by_corners.rig, {.max_moments = 20});
  ASSERT_TRUE(refined.is_accepted) << refined.reason;
  ASSERT_EQ(refined.lens_blurs.size(), 1U);
  EXPECT_EQ(refined.lens_blurs[0].camera, filmed.rig.cameras[0].name);
  EXPECT_NEAR(refined.lens_blurs[0].sigma_px, 0.5, 0.1);
}

TEST(RefinedMap, NamesOptionsOutOfRange) {
  const FilmedRoom& filmed = FilmedRoom::once();
  const auto error = [&](const RefinementOptions& options) {
    return test::error_of(ErrorKind::kInvalidInput,
                          [&] { refine_map(filmed.by_corners, filmed.frames, filmed.rig, options); });
  };
  EXPECT_EQ(error({.max_moments = 11}), "max_moments: must be 12 or more (is 11)");
  EXPECT_EQ(error({.picture_bias_px = -1.0}), "picture_bias_px: must be in [0, 100] (is -1)");
  EXPECT_EQ(error({.num_threads = -1}), "num_threads: must be 0 (all cores) or more (is -1)");
}

TEST(RefinedMap, IsOfTheCamerasThatItWasCalibratedWith) {
  const FilmedRoom& filmed = FilmedRoom::once();
  CameraRig other = filmed.rig;
  other.cameras.push_back(other.cameras[0]);
  other.cameras.back().name = "another";
  EXPECT_THAT(test::error_of(ErrorKind::kInvalidInput,
                             [&] { refine_map(filmed.by_corners, filmed.frames, other, {}); }),
              ::testing::StartsWith("rig: must have the cameras that the map was calibrated with"));
}

}  // namespace
}  // namespace apriltrack
