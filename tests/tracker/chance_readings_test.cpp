#include "chance_readings.h"

#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "blur_film.h"

namespace apriltrack::test {
namespace {

using ::testing::HasSubstr;

TEST(ChanceReadings, AreAsFrequentAsCoinsMakeCodes) {
  EXPECT_DOUBLE_EQ(chance_of_reading("tag16h5", 1, 0), 4.0 / 65536.0);
  EXPECT_DOUBLE_EQ(chance_of_reading("tag16h5", 14, 1), 4.0 * 14.0 * 16.0 / 65536.0);
  EXPECT_NEAR(chance_of_reading("tag36h11", 587, 2), 4.0 * 587.0 * 36.0 * 35.0 / 2.0 / 68719476736.0, 1e-12);
}

/// The film of a scene whose tags are of a family with 16 bits.
BlurFilm of_few_bits(Scene scene, int num_frames) {
  for (MapTag& tag : scene.map.tags) tag.key.family = "tag16h5";
  Body& body = scene.bodies[0];
  body.panels.clear();
  add_tags(body, scene.map, {.margin_cells = 0.5});
  scene.num_frames = num_frames;
  return {scene, 6};
}

BlurTracker tracker_with(const BlurFilm& film, int num_elsewhere) {
  TagMap map = film.scene.map;
  for (int i = 0; i < num_elsewhere; ++i) {
    MapTag tag = map.tags[0];
    tag.key.id = 12 + i;
    tag.T_map_tag = Pose(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0.0, 0.0, 20.0 + i));
    map.tags.push_back(tag);
  }
  BlurTrackerOptions options;
  options.mode = film.scene.truth == TruthKind::kJoint ? TrackMode::kJoint : TrackMode::kEgo;
  return {film.scene.camera, map, options};
}

TEST(ChanceReadings, AreToldFromTheOnlyTagOfAMap) {
  const BlurFilm film = of_few_bits(still_tag().scene, 3);
  for (const TrackResult& result : tracked(tracker_with(film, 0), film)) EXPECT_TRUE(has_evidence(result));
}

TEST(ChanceReadings, OfOneTagOfManyAreClaimedByNoFrame) {
  const BlurFilm film = of_few_bits(still_tag().scene, 3);
  for (const TrackResult& result : tracked(tracker_with(film, 15), film)) {
    EXPECT_EQ(result.tags_detected, 1);
    EXPECT_EQ(result.status, TrackStatus::kLost);
    EXPECT_THAT(result.reason, HasSubstr("chance"));
  }
}

TEST(ChanceReadings, OfSeveralTagsThatAgreeAreClaimed) {
  const BlurFilm film = of_few_bits(shaken_camera().scene, 4);
  for (const TrackResult& result : tracked(tracker_with(film, 15), film)) {
    EXPECT_GE(result.tags_detected, 2);
    EXPECT_TRUE(has_evidence(result)) << result.reason;
  }
}

}  // namespace
}  // namespace apriltrack::test
