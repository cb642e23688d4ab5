// Views for which the detector claims covariances, and of which some err by more: gloss, shadows.
#include <gmock/gmock.h>

#include <cmath>

#include "adjusted_world.h"
#include "apriltrack/geometry/rotation.h"
#include "calibrating.h"
#include "faults/tag_fit.h"
#include "uncertainty/noise_scale.h"
#include "uncertainty/viewpoint_shares.h"

namespace apriltrack {
namespace {

using test::calibrate;
using test::SyntheticWorld;

SyntheticWorld room() {
  return test::make_room(12, 120, test::perspective_camera());
}

/// Normal errors of `sigma_px` per coordinate, of which the detector claims `claim_px`.
void add_claimed_noise(Detection& detection, double sigma_px, double claim_px, RandomStream& random) {
  for (Eigen::Vector2d& corner : detection.corners_px)
    corner += sigma_px * Eigen::Vector2d{random.normal(), random.normal()};
  detection.covariance_px2 = claim_px * claim_px * CornerCovariance::Identity();
}

std::vector<FrameDetections> filmed_with_claims(const std::vector<FrameDetections>& exact, double sigma_px,
                                                RandomStream& random) {
  std::vector<FrameDetections> frames = exact;
  for (FrameDetections& frame : frames)
    for (Detection& detection : frame.detections) add_claimed_noise(detection, sigma_px, sigma_px, random);
  return frames;
}

/// Gloss: from view `first` of the tag on, as many views as that err alike.
void add_gloss(std::vector<FrameDetections>& frames, int id, std::size_t first, std::size_t views,
               double error_px, RandomStream& random) {
  std::array<Eigen::Vector2d, kNumCorners> error;
  for (Eigen::Vector2d& of_corner : error)
    of_corner = error_px * Eigen::Vector2d{random.normal(), random.normal()};
  std::size_t rank = 0;
  for (FrameDetections& frame : frames) {
    for (Detection& detection : frame.detections) {
      if (detection.tag.id != id || rank++ < first || rank > first + views) continue;
      for (std::size_t corner = 0; corner < kNumCorners; ++corner)
        detection.corners_px[corner] += (1.0 + 0.1 * random.normal()) * error[corner];
    }
  }
}

// Of claims of .005 and .05 px, by chance: what is beyond them shows in the small ones.
TEST(ClaimedViews, TellWhatCornersErrByBeyondTheirClaims) {
  for (const double beyond_px : {0.005, 0.04}) {
    std::vector<FrameDetections> frames = test::exact_detections(room());
    RandomStream random(3);
    for (FrameDetections& frame : frames) {
      for (Detection& detection : frame.detections) {
        const double claim_px = random.uniform() < 0.5 ? 0.005 : 0.05;
        add_claimed_noise(detection, std::hypot(claim_px, beyond_px), claim_px, random);
      }
    }
    const test::AdjustedWorld one(room(), frames);
    const double ratio = one.solved.state.noise.beyond_px / beyond_px;
    EXPECT_GT(ratio, 0.7) << beyond_px;
    EXPECT_LT(ratio, 1.5) << beyond_px;
  }
}

TEST(ClaimedViews, CountTheLessTheMoreTheyErrBeyondTheirClaims) {
  RandomStream random(4);
  std::vector<FrameDetections> frames = filmed_with_claims(test::exact_detections(room()), 0.02, random);
  add_gloss(frames, 5, 10, 6, 0.2, random);
  const test::AdjustedWorld one(room(), frames);
  EXPECT_EQ(one.solved.part.views.size(), one.offered.views.size());  // none is rejected
  const int tag = one.index_of(5);
  std::size_t rank = 0;
  for (const TagView& view : one.observations.views) {
    if (view.tag != tag) continue;
    const double scale = one.solved.state.noise.of_view[view.index];
    const bool has_gloss = rank >= 10 && rank < 16;
    EXPECT_GT(scale, has_gloss ? 2.0 : 0.5) << rank;
    EXPECT_LT(scale, has_gloss ? 20.0 : 1.8) << rank;
    ++rank;
  }
}

// Five sigmas and more of what is claimed, in a tenth of a tag's views.
TEST(ClaimedViews, OfGlossAccuseNoTag) {
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
    RandomStream random(seed);
    std::vector<FrameDetections> frames = filmed_with_claims(test::exact_detections(room()), 0.01, random);
    for (const int id : {2, 5, 8}) add_gloss(frames, id, 7, 4, 0.1, random);
    const CalibrationResult result = calibrate(room(), frames);
    EXPECT_EQ(result.map.tags.size(), 12U) << seed;
    EXPECT_THAT(result.warnings, testing::IsEmpty()) << seed;
  }
}

TEST(ClaimedViews, OfATagThatSwingsTellThatItIsLoose) {
  constexpr int kLoose = 5;
  RandomStream swing(7), random(8);
  std::vector<FrameDetections> frames = filmed_with_claims(
      test::filmed_with(room(), kLoose,
                        [&](const Eigen::Vector3d& corner, std::size_t i) {
                          const double t = 0.9 * static_cast<double>(i);
                          const Pose to(rotation_exp({0.05 * std::sin(t), 0.05 * std::cos(1.3 * t), 0.0}),
                                        Eigen::Vector3d(0.004 * std::sin(0.7 * t), 0.004 * std::cos(t), 0.0));
                          return Eigen::Vector3d(to * corner);
                        }),
      0.01, random);
  const CalibrationResult result = calibrate(room(), frames);
  EXPECT_THAT(result.warnings, testing::Contains(testing::AllOf(testing::HasSubstr("tag36h11/5 "),
                                                                testing::HasSubstr("hangs loosely"))));
  EXPECT_EQ(result.map.tags.size(), 11U);
}

TEST(ClaimedViews, OfATagThatMovedTellThatItDid) {
  constexpr int kMoved = 5;
  RandomStream random(9);
  std::vector<FrameDetections> frames = filmed_with_claims(
      test::filmed_with(room(), kMoved,
                        [&](const Eigen::Vector3d& corner, std::size_t i) {
                          return Eigen::Vector3d(i < 60 ? corner : corner + Eigen::Vector3d(0.03, 0.0, 0.0));
                        }),
      0.01, random);
  const CalibrationResult result = calibrate(room(), frames);
  EXPECT_THAT(result.warnings,
              testing::Contains(testing::AllOf(testing::HasSubstr("tag36h11/5 was moved by 0.0"))));
  EXPECT_EQ(result.map.tags.size(), 11U);
}

TEST(ViewpointShares, CountAsOneWhatFollowsFromNearlyOnePlace) {
  const std::vector<double> shares = viewpoint_shares(
      {{0.0, 0.0, 3.0}, {0.1, 0.0, 3.0}, {0.2, 0.0, 3.1}, {1.0, 0.0, 3.0}, {0.0, 0.0, 3.0}, {0.0, 0.0, 3.5}});
  EXPECT_THAT(shares, testing::ElementsAre(1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0, 1.0, 1.0, 1.0));
  EXPECT_TRUE(viewpoint_shares({}).empty());
}

// Of errors by Student's distribution, as of normal ones where nothing is claimed.
TEST(ProbeCost, IsTheUsualOneOnAverage) {
  TagView claimed;
  claimed.claimed_px2 = 1e-4;
  ProbeView probe;
  probe.view = &claimed;
  RandomStream random(10);
  const auto squares_of = [&](int numbers) {
    double sum = 0.0;
    for (int i = 0; i < numbers; ++i) sum += std::pow(random.normal(), 2);
    return sum;
  };
  double sum = 0.0;
  constexpr int kDraws = 100'000;
  for (int i = 0; i < kDraws; ++i)
    sum += cost_of_squares(probe, squares_of(8) / (squares_of(4) / kTailFreedom));
  EXPECT_NEAR(sum / kDraws, usual_probe_cost(), 0.05);
}

}  // namespace
}  // namespace apriltrack
