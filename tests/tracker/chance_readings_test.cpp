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

/// Whether a reading with so many bits corrected may be chance, in a map of so many tags of this family and
/// one of another.
bool may_be_chance(const std::string& family, int num_mapped, int corrected_bits, bool with_another) {
  TagMap map;
  map.tags.resize(static_cast<std::size_t>(num_mapped));
  for (MapTag& tag : map.tags) tag.key.family = family;
  if (with_another) map.tags.emplace_back().key.family = "tagStandard41h12";
  TagObservation seen;
  seen.tag = &map.tags.front();
  seen.corrected_bits = corrected_bits;
  return ReadingOdds(map).may_be_chance(seen);
}

TEST(ReadingOdds, AreOfTheFamilyTheMapAndTheBitsCorrected) {
  EXPECT_FALSE(may_be_chance("tag16h5", 1, 0, false)) << "nothing else could confirm it";
  EXPECT_TRUE(may_be_chance("tag16h5", 1, 1, false));
  EXPECT_TRUE(may_be_chance("tag16h5", 1, 0, true));
  EXPECT_TRUE(may_be_chance("tag16h5", 2, 0, false));
  EXPECT_FALSE(may_be_chance("tag25h9", 35, 0, false));
  EXPECT_FALSE(may_be_chance("tag25h9", 3, 1, false));
  EXPECT_TRUE(may_be_chance("tag25h9", 4, 1, false));
  EXPECT_FALSE(may_be_chance("tag36h11", 587, 1, false));
  EXPECT_FALSE(may_be_chance("tag36h11", 272, 2, false));
  EXPECT_TRUE(may_be_chance("tag36h11", 273, 2, false));
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

TEST(ChanceReadings, OfFourTagsAreTooMany) {
  const BlurFilm film = of_few_bits(still_tag().scene, 3);
  for (const TrackResult& result : tracked(tracker_with(film, 3), film))
    EXPECT_EQ(result.status, TrackStatus::kLost);
}

TEST(ChanceReadings, OfSeveralTagsThatAgreeAreClaimed) {
  const BlurFilm film = of_few_bits(shaken_camera().scene, 4);
  for (const TrackResult& result : tracked(tracker_with(film, 15), film)) {
    EXPECT_GE(result.tags_detected, 2);
    EXPECT_TRUE(has_evidence(result)) << result.reason;
  }
}

TEST(ChanceReadings, OfATagThatOnceFittedOthersStartNoMotionAnew) {
  Scene scene = shaken_camera().scene;
  scene.map.tags[0].key.id = still_tag().scene.map.tags[0].key.id;
  const BlurFilm film = of_few_bits(scene, 3);
  BlurTracker tracker = tracker_with(film, 15);
  for (std::size_t i = 0; i < film.size(); ++i)
    ASSERT_TRUE(has_evidence(tracker.track(film.frames[i].frame(), film.detections[i])));
  // A minute later, elsewhere, the same picture alone.
  const BlurFilm elsewhere = of_few_bits(still_tag().scene, 1);
  Frame later = elsewhere.frames[0].frame();
  later.timestamp.ns += 60'000'000'000;
  ASSERT_EQ(elsewhere.detections[0].size(), 1U);
  const TrackResult result = tracker.track(later, elsewhere.detections[0]);
  EXPECT_FALSE(has_evidence(result));
  EXPECT_THAT(result.reason, HasSubstr("chance"));
}

}  // namespace
}  // namespace apriltrack::test
