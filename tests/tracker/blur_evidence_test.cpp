#include <gtest/gtest.h>

#include <vector>

#include "apriltrack/tracker/blur_tracker.h"
#include "blur_film.h"

namespace apriltrack::test {
namespace {

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

TEST(BlurTracker, FindsTheTagAgainAfterAFewDroppedFrames) {
  const BlurFilm& film = waved_tag();
  int num_claims = 0;
  for (const std::size_t last : {3U, 17U}) {
    BlurTracker tracker = tracker_of(film);
    for (std::size_t i = last - 2; i <= last; ++i) tracker.track(film.frames[i].frame(), film.detections[i]);
    const RenderedFrame& next = film.frames[last + 3];
    const TrackResult result = tracker.track(next.frame(), {});
    if (!has_evidence(result)) continue;
    EXPECT_LT(film.corner_error_px(last + 3, *result.pose), 3.0) << "after " << last;
    ++num_claims;
  }
  EXPECT_GE(num_claims, 1);
}

TEST(BlurTracker, NamesTheTagThatWasMovedSinceTheMapWasMade) {
  const BlurFilm& film = shaken_camera();
  TagMap map = film.scene.map;
  const Pose moved_pose = map.tags[2].T_map_tag * Pose(Eigen::Quaterniond::Identity(), {0.0, 0.06, 0.0});
  map.tags[2].T_map_tag = moved_pose;
  BlurTracker tracker(film.scene.camera, map);
  const TrackResult result = tracker.track(film.frames[0].frame(), film.detections[0]);
  ASSERT_EQ(film.detections[0].size(), 3U);
  ASSERT_TRUE(has_evidence(result));
  EXPECT_EQ(result.contradicting_tags, std::vector<TagKey>{map.tags[2].key});
  EXPECT_EQ(result.tags_tracked, 2);
  EXPECT_LT(film.corner_error_px(0, *result.pose), 1.0);
}

TEST(BlurTracker, SaysWhatDoesNotFitWhereOnlyTheCornersDo) {
  const BlurFilm& film = shaken_camera();
  const std::vector<std::uint8_t> grey(320 * 240, 90);
  for (const std::size_t num_tags : {1U, 3U}) {
    BlurTracker tracker = tracker_of(film);
    Frame frame = film.frames[0].frame();
    frame.image = {grey.data(), 320, 240, 320};
    std::vector<Detection> detections = film.detections[0];
    ASSERT_GE(detections.size(), num_tags);
    detections.resize(num_tags);
    const TrackResult result = tracker.track(frame, detections);
    EXPECT_EQ(result.status, TrackStatus::kLost);
    EXPECT_EQ(result.reason,
              "a pose fits the corners, but not the pixels around them: exposure, or response?");
  }
}

TEST(BlurTracker, GoesOnAfterFramesWhoseTimeStampsAreWrong) {
  const BlurFilm& film = waved_tag();
  BlurTracker tracker = tracker_of(film), undisturbed = tracker_of(film);
  for (std::size_t i = 0; i < film.size(); ++i) {
    const TrackResult result = tracker.track(film.frames[i].frame(), film.detections[i]);
    const TrackResult expected = undisturbed.track(film.frames[i].frame(), film.detections[i]);
    ASSERT_EQ(result.status, expected.status) << "frame " << i;
    ASSERT_TRUE(result.pose->matrix() == expected.pose->matrix()) << "frame " << i;
    for (const std::int64_t back_ns : {0, 5'000'000, 99'000'000}) {
      Frame again = film.frames[i].frame();
      again.timestamp.ns -= back_ns;
      const TrackResult wrong = tracker.track(again, film.detections[i]);
      EXPECT_EQ(wrong.status, TrackStatus::kLost);
      EXPECT_EQ(wrong.reason, "the time stamp is not later than that of the frame before");
    }
  }
}

TEST(BlurTracker, LosesNoFrameToBlankOnesBetween) {
  const BlurFilm& film = waved_tag();
  BlurTracker tracker = tracker_of(film);
  for (std::size_t i = 0; i < film.size(); ++i) {
    const RenderedFrame& shown = film.frames[i];
    if (i % 4 != 3) {
      EXPECT_TRUE(has_evidence(tracker.track(shown.frame(), film.detections[i]))) << "frame " << i;
      continue;
    }
    const std::vector<std::uint8_t> grey(320 * 240, static_cast<std::uint8_t>(60 * (i % 5)));
    Frame frame = shown.frame();
    frame.image = {grey.data(), 320, 240, 320};
    const TrackResult blank = tracker.track(frame, {});
    EXPECT_EQ(blank.status, TrackStatus::kPredicted) << "frame " << i;
    EXPECT_TRUE(blank.pose && blank.covariance) << "frame " << i;
  }
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
