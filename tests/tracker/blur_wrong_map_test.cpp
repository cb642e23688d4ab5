#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "apriltrack/geometry/rotation.h"
#include "apriltrack/photometric/evidence.h"
#include "apriltrack/photometric/light.h"
#include "apriltrack/tracker/blur_tracker.h"
#include "blur_film.h"

namespace apriltrack::test {
namespace {

std::set<TagKey> suspects(const TrackResult& result) {
  std::set<TagKey> keys;
  for (const TagReport& report : result.tags) {
    if (report.state == TagState::kSuspect) keys.insert(report.tag);
  }
  return keys;
}

struct Displacement {
  std::size_t tag;
  Eigen::Vector3d shift_m;
  double turn_rad;
};

class MovedTag : public ::testing::TestWithParam<Displacement> {};
// A tag of 16 cm. Small moves are taken up by the fit of all, large ones are not.
INSTANTIATE_TEST_SUITE_P(Moves, MovedTag,
                         ::testing::Values(Displacement{1, {0.10, 0.0, 0.0}, 0.35},
                                           Displacement{0, {0.0, 0.05, 0.0}, 0.3},
                                           Displacement{2, {0.02, 0.0, 0.02}, 0.5}));

TEST_P(MovedTag, IsFoundLeftOutAndNamedAndNoClaimIsWrong) {
  const BlurFilm& film = shaken_camera();
  TagMap map = film.scene.map;
  MapTag& moved = map.tags[GetParam().tag];
  moved.T_map_tag = moved.T_map_tag * Pose(rotation_exp({0.0, GetParam().turn_rad, 0.0}), GetParam().shift_m);
  BlurTrackerOptions options;
  options.num_particles = 60;
  BlurTracker tracker(film.scene.camera, map, options);
  int num_claims = 0, num_named = 0;
  for (std::size_t i = 0; i < film.size(); ++i) {
    const TrackResult result = tracker.track(film.frames[i].frame(), film.detections[i]);
    if (!has_evidence(result)) continue;
    ++num_claims;
    EXPECT_LT(film.corner_error_px(i, *result.pose), 10.0) << "frame " << i;
    const std::set<TagKey> found = suspects(result);
    for (const TagKey& key : found) EXPECT_EQ(key, moved.key) << "frame " << i;
    num_named += std::ranges::count(result.contradicting_tags, moved.key) > 0 ? 1 : 0;
  }
  EXPECT_GE(num_claims, 18);
  EXPECT_GE(num_named, 12);
}

TEST(BlurTracker, KnowsNothingOfTheRecordingBefore) {
  const BlurFilm& film = shaken_camera();
  TagMap map = film.scene.map;
  MapTag& moved = map.tags[1];
  moved.T_map_tag = moved.T_map_tag * Pose(rotation_exp({0.0, 0.35, 0.0}), {0.10, 0.0, 0.0});
  BlurTrackerOptions options;
  options.num_particles = 60;
  const auto track = [&](BlurTracker& tracker, std::size_t i, std::vector<Detection> detections) {
    Frame frame = film.frames[i].frame();
    frame.exposure_s.reset();  // learned, too
    return tracker.track(frame, detections);
  };
  BlurTracker used(film.scene.camera, map, options), fresh(film.scene.camera, map, options);
  TrackResult last;
  for (std::size_t i = 0; i < film.size(); ++i) last = track(used, i, film.detections[i]);
  EXPECT_EQ(suspects(last), std::set<TagKey>{moved.key});

  for (std::size_t i = 0; i < film.size(); ++i) {
    std::vector<Detection> detections = film.detections[i];
    std::erase_if(detections, [&](const Detection& detection) { return detection.tag == moved.key; });
    const TrackResult expected = track(fresh, i, detections), again = track(used, i, detections);
    ASSERT_EQ(again.status, expected.status) << "frame " << i;
    EXPECT_EQ(again.exposure->exposure_s, expected.exposure->exposure_s) << "frame " << i;
    ASSERT_EQ(again.tags.size(), expected.tags.size()) << "frame " << i;
    for (std::size_t k = 0; k < expected.tags.size(); ++k)
      EXPECT_EQ(again.tags[k].state, expected.tags[k].state) << "frame " << i;
    ASSERT_EQ(again.pose.has_value(), expected.pose.has_value()) << "frame " << i;
    if (!expected.pose) continue;
    EXPECT_EQ(again.pose->translation(), expected.pose->translation()) << "frame " << i;
    EXPECT_EQ(*again.covariance, *expected.covariance) << "frame " << i;
  }
}

TEST(BlurTracker, ReportsWhatEveryTagInViewSays) {
  const BlurFilm& film = shaken_camera();
  BlurTracker tracker = tracker_of(film);
  for (std::size_t i = 0; i < film.size(); ++i) {
    const TrackResult result = tracker.track(film.frames[i].frame(), film.detections[i]);
    if (!has_evidence(result)) continue;
    EXPECT_TRUE(result.contradicting_tags.empty()) << "frame " << i;
    EXPECT_TRUE(suspects(result).empty()) << "frame " << i;
    EXPECT_EQ(std::ranges::count(result.tags, true, &TagReport::is_read), result.tags_detected);
    const auto num_used = std::ranges::count(result.tags, TagState::kUsed, &TagReport::state);
    EXPECT_EQ(num_used, result.tags_tracked) << "frame " << i;
    for (const TagReport& report : result.tags) {
      if (report.state != TagState::kUsed) continue;
      EXPECT_GT(report.correlation, 0.85) << "frame " << i;
      // Nearly all that is there to be explained; 0.85 is a correlation, 0.72 of the variance.
      EXPECT_GT(report.found_share, 0.72 * report.expected_share) << "frame " << i;
      EXPECT_LE(report.found_share, 1.0) << "frame " << i;
      EXPECT_GT(report.expected_share, 0.5) << "frame " << i;
      EXPECT_GT(report.log_odds, 10.0) << "frame " << i;
    }
  }
}

TEST(Identity, TellsATagFromAnotherInItsPlace) {
  const BlurFilm& film = waved_tag();
  for (const int id : {5, 6, 40}) {  // it is 5
    TagMap map = film.scene.map;
    map.tags[0].key.id = id;
    PhotometricWorld world(film.scene.camera, map, TrackMode::kJoint, 320, 240);
    const PhotometricFrame frame{
        light_pyramid(to_linear_light(film.frames[0].frame().image, film.scene.camera.response),
                      PhotometricWorld::kNumLevels),
        0.0};
    MotionState state;
    state.pose = film.frames[0].truth;
    const double log_odds = identity_log_odds(world, frame, state, weigh_evidence(world, frame, state));
    EXPECT_EQ(log_odds > 60.0, id == 5) << id << ": " << log_odds;
    EXPECT_EQ(log_odds < 10.0, id != 5) << id << ": " << log_odds;
  }
}

}  // namespace
}  // namespace apriltrack::test
