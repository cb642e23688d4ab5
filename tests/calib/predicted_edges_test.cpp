// Weights that follow the corners' own errors pull at a map: of small tags its scale shows by how much.
#include "cameras/predicted_edges.h"

#include <gtest/gtest.h>

#include <cmath>

#include "adjusted_world.h"
#include "calibrating.h"
#include "cameras/camera_refinement.h"
#include "filmed_cameras.h"

namespace apriltrack {
namespace {

using test::SyntheticWorld;
using test::tag36h11;

constexpr int kTagsOfRow = 8;
constexpr double kNoiseOfRow_px = 0.3;

/// Eight tags in a row, 36 px wide, filmed from near their front, each frame two neighbours.
SyntheticWorld row_of_small_tags(RandomStream& random, int frames_of_pair) {
  SyntheticWorld world;
  for (int i = 0; i < kTagsOfRow; ++i) {
    const Eigen::Vector3d place{0.17 * i, 2.0, 0.06 * random.normal()};
    const Eigen::Vector3d normal{0.3 * random.normal(), 1.0, 0.3 * random.normal()};
    test::add_tag(world, 0.12, test::looking_along(place, normal));
  }
  world.rig.cameras.push_back(test::perspective_camera());
  for (int k = 0; k < frames_of_pair * (kTagsOfRow - 1); ++k) {
    const double x = 0.17 * (k % (kTagsOfRow - 1)) + 0.085;
    const Eigen::Vector3d eye{x + 0.16 * random.normal(), 0.2 * std::sin(1.3 * k), 0.16 * random.normal()};
    world.T_world_rig.push_back(test::looking_along(eye, Eigen::Vector3d(x, 2.0, 0.0) - eye));
  }
  return world;
}

/// By how many of its sigmas the edge offset is found off; it is 0.
double sigmas_off(test::AdjustedWorld& one) {
  AdjustedPart solved = one.solved;
  const CameraRefinement refined = refine_cameras(one.task(), one.offered, edge_offset_parameters({0}, 0.2),
                                                  -1.0, solved, parallel_for(1));
  EXPECT_TRUE(refined.is_accepted) << refined.reason;
  if (!refined.is_accepted) return 1e9;
  return refined.estimates[0].value / refined.estimates[0].sigma;
}

std::vector<FrameDetections> film(const SyntheticWorld& world, RandomStream& random) {
  std::vector<FrameDetections> frames = test::exact_detections(world);
  test::show_two_neighbours(kTagsOfRow, frames);
  test::add_edge_noise(frames, kNoiseOfRow_px, -0.45, random);
  return frames;
}

// By weights that follow the errors, edges seem a third of a pixel aside.
TEST(PredictedEdges, KeepTheEdgeOffsetOfSmallTags) {
  for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
    RandomStream random(seed);
    const SyntheticWorld world = row_of_small_tags(random, 30);
    test::AdjustedWorld one(world, film(world, random));
    EXPECT_LT(sigmas_off(one), -3.0) << seed;
    take_edges_from_map(one.solved.part.views, one.solved.state,
                        {one.options.corner_sigma_px, one.options.edge_end_correlation}, one.observations);
    EXPECT_LT(std::abs(sigmas_off(one)), 2.5) << seed;
  }
}

/// Corners that are far off, and nothing made of them yet.
struct SpoiltCorners : test::AdjustedWorld {
  Observations exact;

  SpoiltCorners() : AdjustedWorld(test::make_room(6, 20, test::perspective_camera())), exact(observations) {
    RandomStream random(7);
    for (TagView& view : observations.views) {
      for (Eigen::Vector2d& corner : view.corners_px)
        corner += 3.0 * Eigen::Vector2d{random.normal(), random.normal()};
      view.whitening.setZero();
      view.inward.setZero();
    }
  }

  void take_edges(const std::vector<std::size_t>& views, const MapState& state) {
    take_edges_from_map(views, state, {options.corner_sigma_px, options.edge_end_correlation}, observations);
  }
};

TEST(PredictedEdges, AreThoseOfTheMap) {
  SpoiltCorners one;
  std::vector<std::size_t> views = one.solved.part.views;
  const std::size_t other = views.back();
  views.pop_back();
  one.take_edges(views, one.solved.state);
  for (const std::size_t v : views) {
    EXPECT_TRUE(one.observations.views[v].whitening.isApprox(one.exact.views[v].whitening, 1e-3)) << v;
    EXPECT_TRUE(one.observations.views[v].inward.isApprox(one.exact.views[v].inward, 1e-3)) << v;
  }
  EXPECT_TRUE(one.observations.views[other].whitening.isZero(0.0));
}

TEST(PredictedEdges, AreNotThoseOfTagsThatTheMapHasEdgeOnOrBehindTheCamera) {
  SpoiltCorners one;
  const std::size_t v = one.solved.part.views.front();
  const TagView& view = one.observations.views[v];
  const auto tag = static_cast<std::size_t>(view.tag), frame = static_cast<std::size_t>(view.frame);
  MapState state = one.solved.state;
  const Eigen::Vector3d sight =
      (state.T_map_tag[tag].translation() - state.T_map_rig[frame].translation()).normalized();
  state.T_map_tag[tag] = Pose(Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitX(), sight),
                              state.T_map_tag[tag].translation());
  one.take_edges({v}, state);
  EXPECT_TRUE(view.whitening.isZero(0.0));
  state = one.solved.state;
  state.T_map_tag[tag] =
      Pose(state.T_map_tag[tag].rotation(), state.T_map_rig[frame].translation() - 2.0 * sight);
  one.take_edges({v}, state);
  EXPECT_TRUE(view.whitening.isZero(0.0));
}

double length_of_row(const TagMap& map) {
  return (map.find(tag36h11(0))->T_map_tag.translation() -
          map.find(tag36h11(kTagsOfRow - 1))->T_map_tag.translation())
      .norm();
}

// By the others the edges of both rooms would be found 0.3 px and more aside, and the rows be two per cent
// too long and more.
TEST(PredictedEdges, KeepTheScaleOfAMap) {
  for (const std::uint64_t seed : {2, 7}) {
    RandomStream random(seed);
    const SyntheticWorld world = row_of_small_tags(random, 30);
    const CalibrationResult result =
        test::calibrate(world, film(world, random), {.edge_offset_sigma_px = 0.2});
    EXPECT_EQ(result.map.tags.size(), std::size_t{kTagsOfRow}) << seed;
    EXPECT_NEAR(length_of_row(result.map) / length_of_row(world.map), 1.0, 0.008) << seed;
  }
}

// Edges that are aside by as much as the pull, to the other side, look by found edges as if they were not.
TEST(PredictedEdges, FindAnOffsetThatThePullHides) {
  for (const std::uint64_t seed : {2, 7}) {
    RandomStream random(seed);
    const SyntheticWorld world = row_of_small_tags(random, 30);
    std::vector<FrameDetections> frames = film(world, random);
    test::move_edges_inward(0.35, frames);
    const CalibrationResult result = test::calibrate(world, frames, {.edge_offset_sigma_px = 0.2});
    // Taken, or counted where frames that are held out do not decide.
    const auto& told = result.corrections.empty() ? result.open_corrections : result.corrections;
    ASSERT_EQ(told.size(), 1U) << seed;
    EXPECT_NEAR(told[0].value, 0.35, 0.2) << seed;  // what is expected pulls
    EXPECT_LT(test::mean_normalised_error(world, result), 2.5) << seed;
  }
}

// A tag that is printed too large hides at first that edges seem aside: they do once it is left out.
TEST(PredictedEdges, KeepTheScaleOfAMapThatAFaultyTagIsLeftOutOf) {
  RandomStream random(5);
  const SyntheticWorld world = row_of_small_tags(random, 30);
  SyntheticWorld printed = world;
  printed.map.tags[3].size_m *= 1.1;
  std::vector<FrameDetections> frames = test::exact_detections(printed);
  for (std::size_t k = 0; k < frames.size(); ++k) {  // three neighbours each
    const int first = static_cast<int>(k) % (kTagsOfRow - 2);
    std::erase_if(frames[k].detections, [&](const Detection& detection) {
      return detection.tag.id < first || detection.tag.id > first + 2;
    });
  }
  test::add_edge_noise(frames, kNoiseOfRow_px, -0.45, random);
  const CalibrationResult result = test::calibrate(world, frames, {.edge_offset_sigma_px = 0.2});
  EXPECT_EQ(result.left_out, std::vector<TagKey>{tag36h11(3)});
  EXPECT_NEAR(length_of_row(result.map) / length_of_row(world.map), 1.0, 0.008);
}

}  // namespace
}  // namespace apriltrack
