#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "allocation_limit.h"
#include "joint_fixture.h"

namespace apriltrack {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

TEST(JointLikelihood, SameBitsOnAnyNumberOfThreads) {
  const PhotometricFrame frame = noise_frame(7);
  RandomStream random(7);
  std::vector<MotionState> hypotheses;
  for (int i = 0; i < 1500; ++i) {  // more than a batch
    const Eigen::Vector2d off_m{random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2)};
    MotionState state = at_rest(facing(off_m.x(), off_m.y(), 0.8));
    for (int k = 0; k < 6; ++k) state.velocity[k] = random.normal();
    hypotheses.push_back(state);
  }
  for (const TagTemplate kind : {TagTemplate::kReference, TagTemplate::kPattern}) {
    JointLikelihoodOptions options = with_references(PatchError::kLinear, 8);
    options.tag_template = kind;
    JointScores serial, threaded;
    for (const int num_threads : {1, 3}) {
      JointLikelihood likelihood(camera_320(), two_tags(), TrackMode::kJoint, options);
      likelihood.set_reference(1, patch_of(frame, options, facing(0.0, 0, 0.7)));
      PhotometricFrame exposed = frame;
      exposed.exposure_s = 0.02;
      likelihood.evaluate(exposed, hypotheses, parallel_for(num_threads),
                          num_threads == 1 ? &serial : &threaded);
    }
    EXPECT_EQ(serial.log_likelihoods, threaded.log_likelihoods);
    EXPECT_NE(serial.log_likelihoods.front(), serial.log_likelihoods.back());
  }
}

TEST(JointLikelihood, ManyTagsTakeLittleMemoryAndChangeNoScore) {
  constexpr int kNumTags = 400;
  TagMap wall;  // 20 x 20 tags, 20 cm apart
  for (int i = 0; i < kNumTags; ++i)
    wall.tags.push_back(tag_at(i, facing(0.2 * (i % 20) - 1.9, 0.2 * (i / 20) - 1.9, 0.0)));
  PhotometricFrame frame = noise_frame(9);
  frame.exposure_s = 0.02;
  RandomStream random(9);
  std::vector<MotionState> hypotheses;
  for (int i = 0; i < 70; ++i) {
    const Eigen::Vector2d off_m{random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5)};
    MotionState state = at_rest(facing(off_m.x(), off_m.y(), 3.0));
    for (int k = 0; k < 3; ++k) state.velocity[k] = random.normal();
    hypotheses.push_back(state);
  }
  JointLikelihoodOptions options;
  options.grid.size = 8;
  options.negligible_log_ratio = std::numeric_limits<double>::infinity();
  JointLikelihood likelihood(camera_320(), wall, TrackMode::kJoint, options);
  JointScores together, threaded, alone;
  {
    // All predictions at once: 28,000 of more than 130 bytes, without what hangs on them.
    const test::AllocationLimit limit(2'500'000);
    ASSERT_NO_THROW(likelihood.evaluate(frame, hypotheses, kSerial, &together));
    ASSERT_NO_THROW(likelihood.evaluate(frame, hypotheses, parallel_for(3), &threaded));
  }
  EXPECT_EQ(together.log_likelihoods, threaded.log_likelihoods);
  int num_seen = 0;
  for (std::size_t i = 0; i < hypotheses.size(); ++i) {
    likelihood.evaluate(frame, {&hypotheses[i], 1}, kSerial, &alone);
    EXPECT_EQ(together.log_likelihoods[i], alone.log_likelihoods[0]);
    for (std::size_t k = 0; k < kNumTags; ++k) {
      EXPECT_EQ(together.tag(i, k).log_likelihood, alone.tag(0, k).log_likelihood);
      EXPECT_EQ(together.tag(i, k).correlation, alone.tag(0, k).correlation);
      num_seen += alone.tag(0, k).seen_share > 0.0 ? 1 : 0;
    }
  }
  EXPECT_GT(num_seen, 70 * 50);
}

TEST(JointLikelihood, AsksForNoMemoryOnceItHasSeenAFrame) {
  PhotometricFrame frame = noise_frame(10);
  frame.exposure_s = 0.02;
  RandomStream random(10);
  std::vector<MotionState> hypotheses;
  for (int i = 0; i < 1500; ++i) {  // more than a batch
    const Eigen::Vector2d off_m{random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2)};
    MotionState state = at_rest(facing(off_m.x(), off_m.y(), 0.8));
    state.velocity[0] = random.normal();
    hypotheses.push_back(state);
  }
  for (const TagTemplate kind : {TagTemplate::kReference, TagTemplate::kPattern}) {
    JointLikelihoodOptions options = with_references(PatchError::kLinear, 16);
    options.tag_template = kind;
    options.coarse_sigmas = 3.0;
    JointLikelihood likelihood(camera_320(), two_tags(), TrackMode::kJoint, options);
    likelihood.set_reference(1, patch_of(frame, options, facing(0.0, 0, 0.7)));
    JointScores first, second;
    likelihood.evaluate(frame, hypotheses, kSerial, &first);
    second = first;
    std::fill(second.log_likelihoods.begin(), second.log_likelihoods.end(), 1e9);
    {
      const test::AllocationLimit limit(1);
      ASSERT_NO_THROW(likelihood.evaluate(frame, hypotheses, kSerial, &second));
    }
    EXPECT_EQ(first.log_likelihoods, second.log_likelihoods);
  }
}

}  // namespace
}  // namespace apriltrack
