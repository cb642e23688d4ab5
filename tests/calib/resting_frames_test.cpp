// Frames of a scene at rest: what errs in one of them errs in all.

#include "observations/resting_frames.h"

#include <gmock/gmock.h>

#include <Eigen/Cholesky>
#include <map>
#include <numbers>

#include "calibrating.h"

namespace apriltrack {
namespace {

using test::SyntheticWorld;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

/// The camera stands at `places` of its way for `frames_at_rest` frames each, and passes the others by. All
/// frames of a place share the errors of a sigma of 0.15 px; those that are new in each are a fifth of it.
struct Standing {
  std::vector<std::size_t> places;
  int frames_at_rest = 40;
};

std::vector<FrameDetections> film(const SyntheticWorld& world, const Standing& standing,
                                  RandomStream& random) {
  std::vector<FrameDetections> passing = test::exact_detections(world), all;
  test::add_edge_noise(passing, 0.15, -0.45, random);
  for (std::size_t k = 0; k < passing.size(); ++k) {
    const bool stands = std::ranges::find(standing.places, k) != standing.places.end();
    std::vector<FrameDetections> here(stands ? static_cast<std::size_t>(standing.frames_at_rest) : 1,
                                      passing[k]);
    test::add_edge_noise(here, 0.03, -0.45, random);
    all.insert(all.end(), here.begin(), here.end());
  }
  for (std::size_t i = 0; i < all.size(); ++i)
    all[i].timestamp.ns = 20'000'000 * static_cast<std::int64_t>(i);
  return all;
}

struct Judged {
  double normalised_error = 0.0;  ///< Mean of xi^T C^-1 xi / 6; 1 where the covariance tells the truth.
  double rms_m = 0.0;
};

Judged judge(const SyntheticWorld& world, const Standing& standing, double same_place_px, int num_trials) {
  Judged judged;
  int count = 0;
  for (int trial = 0; trial < num_trials; ++trial) {
    RandomStream random(112, static_cast<std::uint64_t>(trial));
    const auto frames = film(world, standing, random);
    const CalibrationResult result =
        test::calibrate(world, frames, {.corner_bias_px = 0.0, .same_place_px = same_place_px});
    for (const MapTag& tag : result.map.tags) {
      if (tag.key == result.held_tag) continue;
      const Pose truth = test::T_origin_tag(world.map, result.held_tag, tag.key);
      const Vector6d xi = (tag.T_map_tag.inverse() * truth).log();
      judged.normalised_error += xi.dot(tag.covariance->ldlt().solve(xi)) / 6.0;
      judged.rms_m += xi.head<3>().squaredNorm();
      ++count;
    }
  }
  EXPECT_GT(count, 0);
  judged.normalised_error /= count;
  judged.rms_m = std::sqrt(judged.rms_m / count);
  return judged;
}

TEST(RestingFramesStatistics, ALongRestAtOnePlaceClaimsNoMoreThanOneView) {
  const SyntheticWorld world = test::make_room(8, 40, test::equidistant_camera());
  const Standing standing{{3, 17, 30}};
  const Judged merged = judge(world, standing, 1.0, 10);
  EXPECT_GT(merged.normalised_error, 0.7);  // ten worlds of seven tags that share a gauge: 0.12 by chance
  EXPECT_LT(merged.normalised_error, 1.5);
  const Judged counted = judge(world, standing, 0.0, 2);
  EXPECT_GT(counted.normalised_error, 2.0) << "the case must be one that counts";
  EXPECT_LT(merged.rms_m, counted.rms_m) << "the places where it stands must not overrule the others";
}

TEST(RestingFrames, OfAFilmThatGoesOnNoneIsMerged) {
  const SyntheticWorld world = test::make_room(8, 60, test::equidistant_camera());
  EXPECT_EQ(test::calibrate(world, test::exact_detections(world)).frames_at_rest, 0);
}

Observations observations_of(const SyntheticWorld& world, const std::vector<FrameDetections>& frames) {
  UnusedDetections unused;
  return collect_observations(frames, world.rig, world.sizes(), {}, unused);
}

/// Frames of one place that differ by independent errors of each coordinate.
std::vector<FrameDetections> at_rest(const SyntheticWorld& world, int num_frames, double sigma_px) {
  RandomStream random(113);
  std::vector<FrameDetections> frames(static_cast<std::size_t>(num_frames), test::exact_detections(world)[4]);
  test::add_noise(frames, sigma_px, random);
  for (std::size_t i = 0; i < frames.size(); ++i)
    frames[i].timestamp.ns = 1000 * static_cast<std::int64_t>(i);
  return frames;
}

TEST(RestingFrames, BecomeTheirMean) {
  const SyntheticWorld world = test::make_room(14, 24, test::equidistant_camera());
  const auto frames = at_rest(world, 50, 0.1);
  Observations observations = observations_of(world, frames);
  const RestingFrames counts = merge_resting_frames(observations, 1.0, {}, {});
  EXPECT_EQ(counts.merged, 49);
  EXPECT_EQ(counts.places, 1);
  ASSERT_EQ(observations.views.size(), frames[0].detections.size());
  for (const TagView& view : observations.views) {
    const TagKey key = observations.tags[static_cast<std::size_t>(view.tag)];
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (const FrameDetections& frame : frames) {
      const auto own = std::ranges::find(frame.detections, key, &Detection::tag);
      mean += own->corners_px[2] / 50.0;
    }
    EXPECT_LT((view.corners_px[2] - mean).norm(), 1e-9);
    EXPECT_EQ(view.num_frames, 50);
  }
}

TEST(RestingFrames, WhatIsSeenNowAndThenIsAveragedWithTheFramesThatShowIt) {
  const SyntheticWorld world = test::make_room(14, 24, test::equidistant_camera());
  auto frames = at_rest(world, 40, 0.05);
  ASSERT_GE(frames[0].detections.size(), 3u);
  const TagKey seldom = frames[0].detections.back().tag;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (i % 4 != 0) frames[i].detections.pop_back();                            // 30 of 40 frames without it
    if (i % 10 == 1) frames[i].detections.erase(frames[i].detections.begin());  // 4 with less than these
  }
  Observations observations = observations_of(world, frames);
  const RestingFrames counts = merge_resting_frames(observations, 1.0, {}, {});
  EXPECT_EQ(counts.places, 2);
  EXPECT_EQ(counts.merged, 38);
  int with_seldom = 0;
  for (const TagView& view : observations.views)
    with_seldom += observations.tags[static_cast<std::size_t>(view.tag)] == seldom ? view.num_frames : 0;
  EXPECT_EQ(with_seldom, 10);
}

TEST(RestingFrames, AnOutlierIsDroppedAndATagThatMovesIsKeptAsItIs) {
  const SyntheticWorld world = test::make_room(14, 24, test::equidistant_camera());
  const auto still = at_rest(world, 40, 0.05);
  ASSERT_GE(still[0].detections.size(), 5u);
  auto with_outlier = still;
  with_outlier[11].detections[1].corners_px[0].x() += 9.0;
  Observations observations = observations_of(world, with_outlier);
  EXPECT_EQ(merge_resting_frames(observations, 1.0, {}, {}).merged, 39);

  auto with_moved = still;
  for (std::size_t i = 20; i < 40; ++i) {
    for (Eigen::Vector2d& corner : with_moved[i].detections[1].corners_px) corner.x() += 9.0;
  }
  observations = observations_of(world, with_moved);
  const RestingFrames counts = merge_resting_frames(observations, 1.0, {}, {});
  EXPECT_EQ(counts.merged, 38) << "both of its places are still there";
  EXPECT_EQ(counts.places, 2);
  const TagKey moved = still[0].detections[1].tag;
  std::vector<double> seen_px;
  for (const TagView& view : observations.views) {
    if (observations.tags[static_cast<std::size_t>(view.tag)] == moved)
      seen_px.push_back(view.corners_px[0].x() - still[0].detections[1].corners_px[0].x());
  }
  std::ranges::sort(seen_px);
  ASSERT_EQ(seen_px.size(), 2u);
  EXPECT_NEAR(seen_px[0], 0.0, 0.3);
  EXPECT_NEAR(seen_px[1], 9.0, 0.3);
}

TEST(RestingFrames, OfATagThatMovedAskewBothPlacesAreStillThere) {
  // The median of its coordinates, each by itself, is at neither of them.
  const SyntheticWorld world = test::make_room(14, 24, test::equidistant_camera());
  auto moved = at_rest(world, 40, 0.05);
  for (std::size_t i = 20; i < 40; ++i) {
    for (Eigen::Vector2d& corner : moved[i].detections[1].corners_px) corner += Eigen::Vector2d(9.0, -9.0);
  }
  Observations observations = observations_of(world, moved);
  const RestingFrames counts = merge_resting_frames(observations, 1.0, {}, {});
  EXPECT_EQ(counts.merged, 38);
  EXPECT_EQ(counts.places, 2);
}

TEST(RestingFrames, OfATagThatSwaysAreNearItsMiddleThoughFarFromEachOther) {
  // On a circle of 0.6 px: from any of its places some others are more than a pixel away, from its middle
  // none.
  const SyntheticWorld world = test::make_room(14, 24, test::equidistant_camera());
  auto swaying = at_rest(world, 12, 0.0);
  ASSERT_GE(swaying[0].detections.size(), 5u);
  for (std::size_t i = 0; i < swaying.size(); ++i) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / 12.0;
    for (Eigen::Vector2d& corner : swaying[i].detections[1].corners_px)
      corner += 0.6 * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  }
  Observations observations = observations_of(world, swaying);
  EXPECT_EQ(merge_resting_frames(observations, 1.0, {}, {}).merged, 11);
}

TEST(RestingFrames, LinksBetweenTagsThatFlickerStay) {
  const SyntheticWorld world = test::make_room(14, 24, test::equidistant_camera());
  auto frames = at_rest(world, 100, 0.05);
  ASSERT_GE(frames[0].detections.size(), 2u);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    auto& seen = frames[i].detections;
    seen.resize(2);
    if (i >= 10)
      seen.erase(i < 70 ? seen.end() - 1 : seen.begin());  // 10 of both, 60 of one, 30 of the other
  }
  Observations observations = observations_of(world, frames);
  merge_resting_frames(observations, 1.0, {}, {});
  std::map<int, int> views_of_frame;
  for (const TagView& view : observations.views) ++views_of_frame[view.frame];
  EXPECT_TRUE(std::ranges::any_of(views_of_frame, [](const auto& one) { return one.second == 2; }));
}

TEST(RestingFrames, ANoisyTagDoesNotKeepTheOthersApart) {
  const SyntheticWorld world = test::make_room(14, 24, test::equidistant_camera());
  auto frames = at_rest(world, 200, 0.05);
  RandomStream random(115);
  for (FrameDetections& frame : frames) {
    for (Eigen::Vector2d& corner : frame.detections[1].corners_px)
      corner += 0.8 * Eigen::Vector2d{random.normal(), random.normal()};
  }
  Observations observations = observations_of(world, frames);
  EXPECT_GT(merge_resting_frames(observations, 1.0, {}, {}).merged, 150);
}

TEST(RestingFrames, AFrameOfWhichMoreIsToldStaysAsItIs) {
  const SyntheticWorld world = test::make_room(14, 24, test::equidistant_camera());
  Observations observations = observations_of(world, at_rest(world, 30, 0.05));
  EXPECT_EQ(merge_resting_frames(observations, 1.0, {}, {Timestamp{7000}}).merged, 28);
  EXPECT_TRUE(std::ranges::any_of(observations.views, [&](const TagView& view) {
    return observations.frames[static_cast<std::size_t>(view.frame)] == Timestamp{7000} &&
           view.num_frames == 1;
  }));
}

TEST(RestingFrames, OfOnePlaceMakeNoMap) {
  const SyntheticWorld world = test::make_room(14, 24, test::equidistant_camera());
  EXPECT_THAT(test::error_of(ErrorKind::kNoResult, [&] { test::calibrate(world, at_rest(world, 50, 0.1)); }),
              HasSubstr("49 of 50 frames show what another shows"));
}

// Each set of tags that is seen together keeps a mean, but all are of one place.
TEST(RestingFrames, OfOnePlaceMakeNoMapThoughTagsFlicker) {
  const SyntheticWorld world = test::make_room(14, 24, test::equidistant_camera());
  auto frames = at_rest(world, 90, 0.1);
  ASSERT_GE(frames[0].detections.size(), 3u);
  for (std::size_t i = 0; i < frames.size(); ++i)
    frames[i].detections.erase(frames[i].detections.begin() + static_cast<std::ptrdiff_t>(i % 3));
  EXPECT_THAT(test::error_of(ErrorKind::kNoResult, [&] { test::calibrate(world, frames); }),
              HasSubstr("frames show what another shows"));
}

// The first frame shares no tag with the next ones; the last show all of them.
TEST(RestingFrames, OfOnePlaceAreThoseWithoutATagInCommonToo) {
  const SyntheticWorld world = test::make_room(14, 24, test::equidistant_camera());
  auto frames = at_rest(world, 60, 0.1);
  const auto seen = static_cast<std::ptrdiff_t>(frames[0].detections.size());
  ASSERT_GE(seen, 5);
  for (std::size_t i = 0; i < 30; ++i) {
    auto& detections = frames[i].detections;
    detections.erase(i == 0 ? detections.begin() + 2 : detections.begin(),
                     i == 0 ? detections.end() : detections.begin() + 2);
  }
  EXPECT_THAT(test::error_of(ErrorKind::kNoResult, [&] { test::calibrate(world, frames); }),
              HasSubstr("frames show what another shows"));
}

// Forty frames of one stand show the tag 10 cm aside, and single ones from elsewhere show it in place.
TEST(RestingFrames, ATagThatHungElsewhereDuringAStandIsTold) {
  const SyntheticWorld world = test::make_room(8, 40, test::equidistant_camera());
  RandomStream random(116);
  std::vector<FrameDetections> frames = film(world, {{17}, 40}, random);
  const TagKey tag = frames[30].detections.front().tag;
  const TagKey unmoved = frames[30].detections.back().tag;
  ASSERT_NE(tag, unmoved);
  EXPECT_THAT(test::calibrate(world, frames).warnings, Not(Contains(HasSubstr("frames of one place"))));
  for (std::size_t i = 17; i < 57; ++i) {
    for (Detection& detection : frames[i].detections) {
      if (detection.tag != tag) continue;
      for (Eigen::Vector2d& corner : detection.corners_px) corner += Eigen::Vector2d(12.0, 5.0);
    }
  }
  const CalibrationResult result = test::calibrate(world, frames);
  EXPECT_THAT(result.warnings,
              Contains(AllOf(HasSubstr(to_string(tag)), HasSubstr("in 40 frames of one place"))));
  EXPECT_THAT(result.warnings, Not(Contains(HasSubstr(to_string(unmoved) + " is not where"))));
}

// Frames that show nothing else do not tell which of the two was moved.
TEST(RestingFrames, OfTwoTagsAloneDuringAStandBothAreTold) {
  const SyntheticWorld world = test::make_room(8, 40, test::equidistant_camera());
  RandomStream random(117);
  std::vector<FrameDetections> frames = film(world, {{17}, 40}, random);
  ASSERT_GE(frames[30].detections.size(), 2u);
  const TagKey a = frames[30].detections[0].tag, b = frames[30].detections[1].tag;
  for (std::size_t i = 17; i < 57; ++i) {
    std::erase_if(frames[i].detections, [&](const Detection& one) { return one.tag != a && one.tag != b; });
    for (Detection& detection : frames[i].detections) {
      if (detection.tag != a) continue;
      for (Eigen::Vector2d& corner : detection.corners_px) corner += Eigen::Vector2d(60.0, 25.0);
    }
  }
  const CalibrationResult result = test::calibrate(world, frames);
  EXPECT_THAT(result.warnings,
              Contains(AllOf(HasSubstr(to_string(a)), HasSubstr(to_string(b)),
                             HasSubstr("do not lie to each other"), HasSubstr("in 40 frames"))));
  EXPECT_THAT(result.warnings, Not(Contains(HasSubstr("is not where"))));
}

TEST(RestingFrames, AFilmThatStandsStillMostOfTheTimeIsWarnedOf) {
  const SyntheticWorld world = test::make_room(8, 40, test::equidistant_camera());
  RandomStream random(114);
  const CalibrationResult result = test::calibrate(world, film(world, {{3, 17}, 60}, random));
  EXPECT_EQ(result.frames_at_rest, 118);
  EXPECT_EQ(result.frames_used, 40);
  EXPECT_THAT(result.warnings, Contains(HasSubstr("118 of 158 frames")));
}

}  // namespace
}  // namespace apriltrack
