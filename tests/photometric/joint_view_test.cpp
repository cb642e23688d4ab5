#include <gtest/gtest.h>

#include <vector>

#include "joint_fixture.h"

namespace apriltrack {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

TEST(JointLikelihood, DoesNotRewardLeavingTheImage) {
  const PhotometricFrame frame = noise_frame(3);
  const Pose truth = facing(0.0, 0.0, 0.5);
  // Out on the left, above, behind the camera, turned away.
  const std::vector<MotionState> gone = {at_rest(facing(-1.0, 0.0, 0.5)), at_rest(facing(0.0, -1.0, 0.5)),
                                         at_rest(facing(0.0, 0.0, -0.5)),
                                         at_rest({rotation_exp({3.14, 0, 0}), {0, 0, 0.5}})};
  std::vector<MotionState> here;
  for (int i = 0; i < 40; ++i) here.push_back(at_rest(facing(0.002 * i - 0.04, 0.0, 0.5)));
  for (const PatchError error : kErrors) {
    JointLikelihoodOptions options = with_references(error);
    options.min_correlation = 0.2;
    const JointScores away = scores_of(options, frame, truth, gone);
    const JointScores in_view = scores_of(options, frame, truth, here);
    int num_better = 0;
    for (std::size_t i = 0; i < gone.size(); ++i) {
      EXPECT_EQ(away.tag(i, 0).seen_share, 0.0);
      EXPECT_EQ(away.log_likelihoods[i], away.log_likelihoods[0]);
      for (std::size_t k = 0; k < here.size(); ++k) {
        if (in_view.tag(k, 0).correlation <= 0.0) continue;
        EXPECT_GE(in_view.log_likelihoods[k], away.log_likelihoods[i]);
        ++num_better;
      }
    }
    EXPECT_GT(num_better, 40);
  }
}

TEST(JointLikelihood, MakesLessOfATagThatIsHalfOut) {
  const PhotometricFrame frame = noise_frame(4);
  const Pose whole = facing(0.0, 0.0, 0.5);
  const Pose half = facing(-159.5 / 400.0 * 0.5, 0.0, 0.5);  // its centre on the leftmost pixels
  for (const PatchError error : kErrors) {
    const JointLikelihoodOptions options = with_references(error);
    // Each compared with its own view: what is seen agrees entirely.
    const JointScores in_view = scores_of(options, frame, whole, {at_rest(whole)});
    const JointScores cut = scores_of(options, frame, half, {at_rest(half)});
    EXPECT_NEAR(cut.tag(0, 0).correlation, 1.0, kMaxError);
    EXPECT_EQ(cut.tag(0, 0).seen_share, 0.5);
    EXPECT_LT(cut.log_likelihoods[0], in_view.log_likelihoods[0] - 1.0);
  }
  const JointScores cut = scores_of(with_references(PatchError::kLinear), frame, half, {at_rest(half)});
  EXPECT_NEAR(cut.log_likelihoods[0], -10.0 * (0.5 - 0.25), kMaxPaperError);
}

TEST(JointLikelihood, MissesNoPartOfATagThatIsInTheImage) {
  const PhotometricFrame frame = noise_frame(8);
  const JointLikelihoodOptions options = with_references(PatchError::kLinear, 8);
  for (const Distortion& lens :
       {Distortion(NoDistortion{}), Distortion(RadtanDistortion({-0.3, 0.1, 2e-3, -1e-3})),
        Distortion(EquidistantDistortion({0.02, 0.0, 0.0, 0.0}))}) {
    Camera camera = camera_320();
    camera.model = CameraModel({200.0, 200.0, 150.0, 130.0}, lens);
    JointLikelihood likelihood(camera, one_tag(), TrackMode::kJoint, options);
    std::vector<double> patch = patch_of(frame, options, facing(0, 0, 0.5));
    likelihood.set_reference(0, patch);
    RandomStream random(8);
    std::vector<MotionState> hypotheses;
    for (int i = 0; i < 3000; ++i) {
      Eigen::Vector3d place{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-0.3, 1.0)};
      hypotheses.push_back(at_rest({rotation_exp(random.normal() * place), place}));
    }
    JointScores scores;
    likelihood.evaluate(frame, hypotheses, kSerial, &scores);
    int num_partly = 0, num_unseen = 0;
    for (std::size_t i = 0; i < hypotheses.size(); ++i) {
      const int seen =
          sample_patch(frame.light[0].view(), camera.model,
                       camera_from_tag_plane(hypotheses[i].pose, kTagSize_m), options.grid, patch);
      EXPECT_EQ(scores.tag(i, 0).seen_share, seen < PatchMatch::kMinSamples ? 0.0 : seen / 64.0);
      num_partly += seen > 0 && seen < 64 ? 1 : 0;
      num_unseen += seen == 0 ? 1 : 0;
    }
    EXPECT_GT(num_partly, 100);
    EXPECT_GT(num_unseen, 500);
  }
}

TEST(JointLikelihood, DoesNotSeeWhatLiesBesideSaturatedPixels) {
  PhotometricFrame frame = noise_frame(11);
  for (int y = 0; y < 240; ++y)
    for (int x = 160; x < 200; ++x) frame.light[0](x, y) = 0.99F;
  JointLikelihoodOptions options = with_references(PatchError::kLinear);
  const Pose pose =
      facing(0.0, 0.0, 0.5);  // 128 pixels wide about pixel 159.5: columns from 159.5 on are bright
  const JointScores all = scores_of(options, frame, pose, {at_rest(pose)});
  options.max_light = 0.985;
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 320; ++x) frame.light[0](x, y) *= x >= 160 && x < 200 ? 1.0F : 0.9F;
  const JointScores unsaturated = scores_of(options, frame, pose, {at_rest(pose)});
  EXPECT_EQ(all.tag(0, 0).seen_share, 1.0);
  // Of 16 columns at 163.5, 171.5 ... 219.5 to the right of the middle, those up to 195.5 are lost.
  EXPECT_EQ(unsaturated.tag(0, 0).seen_share, 11.0 / 16.0);
}

}  // namespace
}  // namespace apriltrack
