#include "apriltrack/photometric/joint_likelihood.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "apriltrack/base/error.h"
#include "joint_fixture.h"

namespace apriltrack {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

TEST(JointLikelihood, FollowsTheErrorChosen) {
  const PhotometricFrame frame = noise_frame(1);
  const Pose truth = facing(0.02, 0.01, 0.5), near = facing(0.0201, 0.0101, 0.5);
  for (const PatchError error : kErrors) {
    JointLikelihoodOptions options = with_references(error);
    options.gamma = 7.0;
    options.kappa = 0.03;
    const JointScores scores = scores_of(options, frame, truth, {at_rest(truth), at_rest(near)});
    const double c = correlate(patch_of(frame, options, near), patch_of(frame, options, truth)).correlation;
    ASSERT_GT(c, 0.2);  // noise moved by a tenth of a pixel
    ASSERT_LT(c, 0.999);
    const double n = 16.0 * 16.0 / 3.0;  // the tag covers 128 x 128 px, far more than the grid has
    const auto expected = [&](double corr) {
      if (error == PatchError::kLinear) return -7.0 * (1.0 - corr) / 2.0;
      if (error == PatchError::kMinusLog) return 7.0 * std::log(corr);
      return -n / 2.0 * (std::log(1.0 - corr * corr + 0.03) - std::log(1.03));
    };
    const double max_error = error == PatchError::kGaussianProfile ? kMaxProfileError : kMaxPaperError;
    EXPECT_NEAR(scores.log_likelihoods[0], expected(1.0), max_error);
    EXPECT_NEAR(scores.log_likelihoods[1], expected(c), max_error);
    EXPECT_NEAR(scores.tag(1, 0).correlation, c, kMaxError);
    EXPECT_EQ(scores.tag(1, 0).seen_share, 1.0);
  }
}

TEST(JointLikelihood, CountsIndependentSamplesOfASmallTag) {
  const PhotometricFrame frame = noise_frame(2);
  const Pose far = facing(0.0, 0.0, 8.0);  // 8 x 8 px: 64 of the grid's 256 samples
  const JointLikelihoodOptions options = with_references(PatchError::kGaussianProfile);
  const JointScores scores = scores_of(options, frame, far, {at_rest(far)});
  EXPECT_NEAR(scores.log_likelihoods[0], -64.0 / 3.0 / 2.0 * std::log(options.kappa / (1.0 + options.kappa)),
              kMaxProfileError);
}

TEST(JointLikelihood, SumsOverTheTagsThatHaveTemplates) {
  const PhotometricFrame frame = noise_frame(5);
  const TagMap map = two_tags();
  const std::vector<MotionState> hypotheses = {at_rest(facing(-0.1, 0, 0.7)),
                                               at_rest(facing(-0.1, 0.001, 0.7))};
  for (const bool is_mean : {false, true}) {
    JointLikelihoodOptions options = with_references(PatchError::kLinear);
    options.average_over_tags = is_mean;
    JointLikelihood likelihood(camera_320(), map, TrackMode::kJoint, options);
    JointScores scores;
    likelihood.evaluate(frame, hypotheses, kSerial, &scores);
    EXPECT_EQ(scores.log_likelihoods, std::vector<double>(2, 0.0));  // no template, no evidence
    for (std::size_t k = 0; k < 2; ++k)
      likelihood.set_reference(k, patch_of(frame, options, hypotheses[0].pose * map.tags[k].T_map_tag));
    likelihood.evaluate(frame, hypotheses, kSerial, &scores);
    EXPECT_NEAR(scores.log_likelihoods[0], 0.0, kMaxPaperError);
    const double sum = scores.tag(1, 0).log_likelihood + scores.tag(1, 1).log_likelihood;
    EXPECT_LT(scores.tag(1, 0).log_likelihood, -0.1);
    EXPECT_LT(scores.tag(1, 1).log_likelihood, -0.1);
    EXPECT_NEAR(scores.log_likelihoods[1], is_mean ? sum / 2.0 : sum, 1e-12);
    likelihood.clear_reference(1);
    likelihood.evaluate(frame, hypotheses, kSerial, &scores);
    EXPECT_EQ(scores.log_likelihoods[1], scores.tag(1, 0).log_likelihood);
  }
}

TEST(JointLikelihood, EgoMotionIsJointMotionSeenFromTheMap) {
  const PhotometricFrame frame = noise_frame(6);
  const TagMap map = two_tags();
  const JointLikelihoodOptions options = with_references(PatchError::kLinear);
  const Pose T_camera_body(rotation_exp({0.1, -0.2, 0.3}), {-0.1, 0.02, 0.7});
  JointScores ego, joint;
  for (const TrackMode mode : {TrackMode::kEgo, TrackMode::kJoint}) {
    JointLikelihood likelihood(camera_320(), map, mode, options);
    for (std::size_t k = 0; k < 2; ++k)
      likelihood.set_reference(k, patch_of(frame, options, facing(0.01, 0, 0.7) * map.tags[k].T_map_tag));
    const bool is_ego = mode == TrackMode::kEgo;
    likelihood.evaluate(frame, std::vector{at_rest(is_ego ? T_camera_body.inverse() : T_camera_body)},
                        kSerial, is_ego ? &ego : &joint);
  }
  EXPECT_NE(joint.log_likelihoods[0], 0.0);
  EXPECT_NEAR(ego.log_likelihoods[0], joint.log_likelihoods[0], kMaxPaperError);
}

TEST(JointLikelihood, RefusesOptionsOutOfRange) {
  JointLikelihoodOptions options;
  options.gamma = -1.0;
  EXPECT_THROW(JointLikelihood(camera_320(), one_tag(), TrackMode::kEgo, options), Error);
  options = {};
  options.coarse_sigmas = -1.0;
  EXPECT_THROW(JointLikelihood(camera_320(), one_tag(), TrackMode::kEgo, options), Error);
  options = {};
  options.max_light = 0.0;
  EXPECT_THROW(JointLikelihood(camera_320(), one_tag(), TrackMode::kEgo, options), Error);
  TagMap map = one_tag();
  map.tags[0].key.id = 100'000;
  EXPECT_THROW(JointLikelihood(camera_320(), map, TrackMode::kEgo), Error);
}

}  // namespace
}  // namespace apriltrack
