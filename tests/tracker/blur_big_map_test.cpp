#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "apriltrack/base/random.h"
#include "apriltrack/geometry/rotation.h"
#include "apriltrack/tracker/blur_tracker.h"
#include "blur_film.h"

namespace apriltrack::test {
namespace {

Eigen::Vector3d any_vector(RandomStream& random) {
  return {random.normal(), random.normal(), random.normal()};
}

/// Where no frame of shaken_camera() shows a tag of 16 cm, whose camera stays near the origin and looks along
/// z: in other buildings, behind it, or before it with the back turned.
Pose out_of_sight(RandomStream& random, int kind) {
  const Eigen::Quaterniond any_turn = rotation_exp(2.0 * any_vector(random));
  if (kind == 0) {
    const double distance_m = 20.0 + 30.0 * random.uniform();
    return {any_turn, distance_m * any_vector(random).normalized()};
  }
  if (kind == 1) return {any_turn, {random.normal(), random.normal(), -random.uniform(1.5, 5.0)}};
  const Eigen::Quaterniond about_face = rotation_exp({3.1, 0.0, 0.0});
  return {about_face, {0.5 * random.normal(), 0.5 * random.normal(), random.uniform(1.0, 4.0)}};
}

/// The film's map with `count` other tags before, between and after its own.
TagMap among_others(const TagMap& seen, const TagKey& first, int count) {
  RandomStream random(5);
  TagMap map = seen;
  map.tags.clear();
  std::size_t num_seen = 0;
  for (int i = 0; i < count; ++i) {
    if (i % (count / static_cast<int>(seen.tags.size())) == 10 && num_seen < seen.tags.size())
      map.tags.push_back(seen.tags[num_seen++]);
    MapTag tag;
    tag.key = {first.family, first.id + i};
    tag.size_m = 0.16;
    tag.T_map_tag = out_of_sight(random, i % 3);
    map.tags.push_back(tag);
  }
  return map;
}

BlurTrackerOptions with_few_particles() {
  BlurTrackerOptions options;
  options.num_particles = 60;
  return options;
}

void expect_same(const TrackResult& big, const TrackResult& small) {
  EXPECT_EQ(big.status, small.status);
  EXPECT_EQ(big.reason, small.reason);
  EXPECT_EQ(big.tags_detected, small.tags_detected);
  EXPECT_EQ(big.tags_tracked, small.tags_tracked);
  EXPECT_EQ(big.contradicting_tags, small.contradicting_tags);
  EXPECT_EQ(big.second_mode_odds, small.second_mode_odds);
  ASSERT_EQ(big.pose.has_value(), small.pose.has_value());
  if (!small.pose) return;
  EXPECT_EQ(big.pose->translation(), small.pose->translation());
  EXPECT_EQ(big.pose->rotation().coeffs(), small.pose->rotation().coeffs());
  EXPECT_EQ(*big.covariance, *small.covariance);
}

TEST(BlurTrackerInABigMap, TracksAsIfNothingElseWereInTheMap) {
  const BlurFilm& film = shaken_camera();
  const TagMap map = among_others(film.scene.map, {"tagStandard52h13", 0}, 3000);
  ASSERT_EQ(map.tags.size(), 3003U);
  BlurTracker small(film.scene.camera, film.scene.map, with_few_particles());
  BlurTracker big(film.scene.camera, map, with_few_particles());
  int num_tracked = 0;
  for (std::size_t i = 0; i < film.size(); ++i) {
    SCOPED_TRACE(i);
    const TrackResult expected = small.track(film.frames[i].frame(), film.detections[i]);
    expect_same(big.track(film.frames[i].frame(), film.detections[i]), expected);
    num_tracked += expected.status == TrackStatus::kTracked ? 1 : 0;
  }
  EXPECT_GE(num_tracked, 4);
}

TEST(BlurTrackerInABigMap, LooksForTagsAsIfNothingElseWereInTheMap) {
  const BlurFilm& film = shaken_camera();
  const TagMap map = among_others(film.scene.map, {"tag36h11", 12}, 570);
  ASSERT_EQ(map.tags.size(), 573U);
  BlurTracker small(film.scene.camera, film.scene.map, with_few_particles());
  BlurTracker big(film.scene.camera, map, with_few_particles());
  for (std::size_t i = 0; i < film.size(); ++i) {
    SCOPED_TRACE(i);
    const TrackResult expected = small.track(film.frames[i].frame());
    expect_same(big.track(film.frames[i].frame()), expected);
  }
}

}  // namespace
}  // namespace apriltrack::test
