#include <gtest/gtest.h>

#include <vector>

#include "apriltrack/tracker/blur_tracker.h"
#include "blur_film.h"

namespace apriltrack::test {
namespace {

/// The map of shaken_camera() with tags of the next room: 2 m behind the wall, where the camera looks.
TagMap map_with_hidden_tags(int count) {
  TagMap map = shaken_camera().scene.map;
  for (int i = 0; i < count; ++i) {
    MapTag tag = map.tags.front();
    tag.key.id = 100 + i;
    tag.T_map_tag = {Eigen::Quaterniond::Identity(), {-0.9 + 0.6 * (i % 4), -0.5 + 0.5 * (i / 4), 3.1}};
    map.tags.push_back(tag);
  }
  return map;
}

class HiddenTagsOfTheMap : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Counts, HiddenTagsOfTheMap, ::testing::Values(2, 12));

TEST_P(HiddenTagsOfTheMap, CostNoFrameAndMakeNoPoseSurer) {
  const BlurFilm& film = shaken_camera();
  BlurTracker plain(film.scene.camera, film.scene.map);
  BlurTracker crowded(film.scene.camera, map_with_hidden_tags(GetParam()));
  int num_read = 0, num_unread = 0;
  for (std::size_t i = 0; i < 12; ++i) {
    const TrackResult expected = plain.track(film.frames[i].frame(), film.detections[i]);
    const TrackResult result = crowded.track(film.frames[i].frame(), film.detections[i]);
    const bool is_read = !film.detections[i].empty();
    (is_read ? num_read : num_unread) += 1;
    EXPECT_EQ(result.status, is_read ? TrackStatus::kDetected : TrackStatus::kTracked) << "frame " << i;
    ASSERT_TRUE(result.pose && expected.pose) << "frame " << i << ": " << result.reason;
    EXPECT_LT(film.corner_error_px(i, *result.pose), 2.0) << "frame " << i;
    EXPECT_GT(result.covariance->trace(), 0.9 * expected.covariance->trace()) << "frame " << i;
  }
  EXPECT_GE(num_read, 4);
  EXPECT_GE(num_unread, 4);
}

TEST(BlurTracker, FindsNothingThatIsNotThereAfterDroppedFrames) {
  // A quarter of a second: the motion's prior is wide enough for a search to find what looks like a blurred
  // tag.
  const BlurFilm& film = waved_tag();
  int num_runs = 0;
  for (const std::size_t last : {2U, 4U}) {
    for (std::size_t next = last + 4; next <= last + 8; next += 2) {
      BlurTracker tracker = tracker_of(film);
      for (std::size_t i = 0; i <= last; ++i) tracker.track(film.frames[i].frame(), film.detections[i]);
      const TrackResult result = tracker.track(film.frames[next].frame(), {});
      const double error_px = has_evidence(result) ? film.corner_error_px(next, *result.pose) : 0.0;
      EXPECT_LT(error_px, 10.0) << "frame " << next << " after " << last;
      ++num_runs;
    }
  }
  EXPECT_EQ(num_runs, 6);
}

TEST(BlurTracker, ForgetsTheMotionWhereTimeRunsBackBehindAPrediction) {
  const BlurFilm& film = waved_tag();
  BlurTracker tracker = tracker_of(film);
  const std::vector<std::uint8_t> black(320 * 240);
  const auto blank = [&](std::int64_t after_ns) {
    Frame frame;
    frame.image = {black.data(), 320, 240, 320};
    frame.timestamp.ns = film.frames[0].timestamp.ns + after_ns;
    return tracker.track(frame, {});
  };
  EXPECT_EQ(tracker.track(film.frames[0].frame(), film.detections[0]).status, TrackStatus::kDetected);
  EXPECT_EQ(blank(400'000'000).status, TrackStatus::kPredicted);
  EXPECT_EQ(blank(100'000'000).status, TrackStatus::kLost);  // earlier than the frame before
}

}  // namespace
}  // namespace apriltrack::test
