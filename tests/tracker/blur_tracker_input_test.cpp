#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "apriltrack/base/check.h"
#include "apriltrack/base/error.h"
#include "apriltrack/base/random.h"
#include "apriltrack/tracker/blur_tracker.h"
#include "blur_film.h"
#include "support/error_message.h"

namespace apriltrack::test {
namespace {

constexpr std::int64_t kFrameInterval_ns = 33'333'333;

TEST(BlurTracker, StartsColdAtTheFirstTagThatIsRead) {
  const BlurFilm& film = waved_tag();
  int num_waiting = 0;
  for (const std::size_t first : {0U, 8U}) {  // sharp, and where nothing can be read
    BlurTracker tracker = tracker_of(film);
    for (std::size_t i = first; i < film.size(); ++i) {
      const TrackResult result = tracker.track(film.frames[i].frame(), film.detections[i]);
      if (film.detections[i].empty()) {
        EXPECT_EQ(result.status, TrackStatus::kLost);
        EXPECT_FALSE(result.pose || result.covariance);
        EXPECT_EQ(result.reason, "no tag seen, and no recent pose to look from");
        ++num_waiting;
        continue;
      }
      EXPECT_EQ(result.status, TrackStatus::kDetected) << "from frame " << first << ", frame " << i;
      ASSERT_TRUE(result.pose);
      EXPECT_LT(film.corner_error_px(i, *result.pose), 0.7);
      EXPECT_EQ(result.tags_detected, 1);
      EXPECT_TRUE(result.reason.empty());
      break;
    }
  }
  EXPECT_GE(num_waiting, 2) << "no test of waiting";
}

TEST(BlurTracker, LosesFramesThatAreNoImage) {
  const BlurFilm& film = waved_tag();
  BlurTracker tracker = tracker_of(film);
  Frame frame = film.frames[0].frame();
  const std::uint8_t* pixels = frame.image.data();
  frame.image = {nullptr, 320, 240, 320};
  EXPECT_EQ(tracker.track(frame).reason, "the image has no pixels: its data is null");
  frame.image = {pixels, 320, 240, 100};
  EXPECT_EQ(tracker.track(frame).reason,
            "the image's rows of 320 pixels are 100 bytes apart: rows cannot overlap");
  frame.image = {pixels + 239 * 320, 320, 240, -320};  // bottom-up, as some cameras' drivers give them
  EXPECT_EQ(
      tracker.track(frame).reason,
      "the image's rows run upwards in memory (its stride is -320), and only rows that run downwards are "
      "read: copy it, the last row first");
  EXPECT_EQ(tracker.track(film.frames[0].frame(), film.detections[0]).status, TrackStatus::kDetected);
}

TEST(BlurTracker, ThatWasMovedFromSaysSo) {
  const BlurFilm& film = waved_tag();
  BlurTracker tracker = tracker_of(film);
  BlurTracker taken = std::move(tracker);
  EXPECT_THROW(tracker.track(film.frames[0].frame()), MisuseError);
  EXPECT_THROW(tracker.prepare(), MisuseError);
  EXPECT_THROW(tracker.detector_options(), MisuseError);
  EXPECT_EQ(taken.track(film.frames[0].frame(), film.detections[0]).status, TrackStatus::kDetected);
  tracker = std::move(taken);
  EXPECT_EQ(tracker.track(film.frames[1].frame(), film.detections[1]).status, TrackStatus::kDetected);
}

TEST(BlurTracker, GoesOnAfterTheMostExtremeTimeStamps) {
  const BlurFilm& film = waved_tag();
  BlurTracker tracker = tracker_of(film);
  for (const std::int64_t time_ns :
       {std::numeric_limits<std::int64_t>::min(), std::int64_t{0}, std::numeric_limits<std::int64_t>::max(),
        std::numeric_limits<std::int64_t>::min()}) {
    Frame frame = film.frames[0].frame();
    frame.timestamp.ns = time_ns;
    EXPECT_EQ(tracker.track(frame, film.detections[0]).status, TrackStatus::kDetected) << time_ns;
  }
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(tracker.track(film.frames[i].frame(), film.detections[i]).status, TrackStatus::kDetected) << i;
}

/// A dark room's image, with grain.
GrayImage grain_image(int width, int height) {
  GrayImage image(width, height);
  RandomStream random(5);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) image(x, y) = static_cast<std::uint8_t>(random.uniform(90.0, 110.0));
  }
  return image;
}

TEST(BlurTracker, PredictsHalfASecondThenIsLostAndStartsAgain) {
  const BlurFilm& film = waved_tag();
  BlurTracker tracker = tracker_of(film);
  const TrackResult before = tracker.track(film.frames[0].frame(), film.detections[0]);
  ASSERT_EQ(before.status, TrackStatus::kDetected);
  const GrayImage grain = grain_image(320, 240);
  Frame frame;
  frame.image = grain.view();
  int num_predicted = 0, num_lost = 0;
  double last_variance = before.covariance->trace();
  for (int i = 1; i <= 20; ++i) {
    frame.timestamp = {film.frames[0].timestamp.ns + i * kFrameInterval_ns};
    const TrackResult result = tracker.track(frame, {});
    const bool is_recent = i * kFrameInterval_ns <= 500'000'000;
    EXPECT_EQ(result.status, is_recent ? TrackStatus::kPredicted : TrackStatus::kLost) << "frame " << i;
    EXPECT_EQ(result.pose.has_value(), is_recent);
    EXPECT_EQ(result.reason.empty(), is_recent);
    EXPECT_EQ(result.tags_tracked, 0);
    (is_recent ? num_predicted : num_lost) += 1;
    if (!is_recent) continue;
    EXPECT_GT(result.covariance->trace(), last_variance) << "frame " << i;  // it knows less and less
    last_variance = result.covariance->trace();
  }
  EXPECT_EQ(num_predicted, 15);
  EXPECT_EQ(num_lost, 5);

  Frame back = film.frames[22].frame();
  back.timestamp = {frame.timestamp.ns + kFrameInterval_ns};
  ASSERT_FALSE(film.detections[22].empty());
  const TrackResult found = tracker.track(back, film.detections[22]);
  EXPECT_EQ(found.status, TrackStatus::kDetected);
  ASSERT_TRUE(found.pose);
  EXPECT_LT(film.corner_error_px(22, *found.pose), 0.5);
}

TEST(BlurTracker, StartsAnewWhereTimeRunsBackwards) {
  const BlurFilm& film = waved_tag();
  BlurTracker tracker = tracker_of(film);
  tracker.track(film.frames[22].frame(), film.detections[22]);
  const TrackResult again = tracker.track(film.frames[2].frame(), film.detections[2]);
  EXPECT_EQ(again.status, TrackStatus::kDetected);
  EXPECT_EQ(
      again.warning,
      "the time stamp is 0.666667 s earlier than that of the frame before: another recording begins, and "
      "nothing is kept of the last");
  EXPECT_EQ(tracker.track(film.frames[3].frame(), film.detections[3]).warning, "");
  EXPECT_LT(film.corner_error_px(2, *again.pose), 0.5);
  const TrackResult blurred = tracker.track(film.frames[0].frame(), {});
  EXPECT_EQ(blurred.status, TrackStatus::kLost);
}

TEST(BlurTracker, TellsWhyAFrameGivesNoPose) {
  const BlurFilm& film = waved_tag();
  BlurTracker tracker = tracker_of(film);
  const GrayImage large = grain_image(640, 480);
  Frame frame;
  frame.image = large.view();
  EXPECT_EQ(tracker.track(frame).reason,
            "the image is 640 x 480 pixels, but the camera is calibrated for 320 x 240");
  frame.image = GrayView();
  EXPECT_EQ(tracker.track(frame).reason, "the image is empty");
  EXPECT_EQ(tracker.track(frame).status, TrackStatus::kLost);

  TagMap elsewhere = film.scene.map;
  elsewhere.tags[0].key.id = 77;
  BlurTracker lost(film.scene.camera, elsewhere, {});
  for (std::size_t i = 0; i < 3; ++i) {
    const TrackResult result = lost.track(film.frames[i].frame(), film.detections[i]);
    EXPECT_EQ(result.status, TrackStatus::kLost);
    EXPECT_EQ(result.tags_detected, 0);
    EXPECT_EQ(result.reason, "no tag of the map seen, and no recent pose to look from");
  }
}

TEST(BlurTracker, TakesNoPoseFromTheMapOfAnotherPlace) {
  // Each tag by itself fits the corners of one; together they never do.
  const BlurFilm& film = shaken_camera();
  TagMap elsewhere = film.scene.map;
  elsewhere.tags[0].T_map_tag = Pose(Eigen::Quaterniond::Identity(), {-1.25, 0.4, 1.1});
  elsewhere.tags[1].T_map_tag = Pose(Eigen::Quaterniond::Identity(), {1.1, -0.35, 1.6});
  BlurTracker tracker(film.scene.camera, elsewhere, {});
  int num_frames = 0;
  for (std::size_t i = 0; i < 5; ++i) {
    ASSERT_EQ(film.detections[i].size(), 3U);
    const TrackResult result = tracker.track(film.frames[i].frame(), film.detections[i]);
    EXPECT_EQ(result.status, TrackStatus::kLost) << "frame " << i;
    EXPECT_EQ(result.reason, "the tags seen do not agree on a pose");
    ++num_frames;
  }
  EXPECT_EQ(num_frames, 5);
}

TEST(BlurTracker, OutlivesExposuresThatMeanNothing) {
  const BlurFilm& film = waved_tag();
  Frame frame = film.frames[0].frame();
  const TrackResult right = tracker_of(film).track(frame, film.detections[0]);
  EXPECT_EQ(right.warning, "");
  for (const auto& [exposure_s, told] : {std::pair(std::nan(""), "nan s"),
                                         {-0.01, "-0.01 s"},
                                         {1e-9, "1e-09 s"},
                                         {10.0, "10 s"},
                                         {1e300, "1e+300 s"}}) {
    frame.exposure_s = exposure_s;  // the camera's own holds instead
    const TrackResult result = tracker_of(film).track(frame, film.detections[0]);
    ASSERT_TRUE(result.pose);
    EXPECT_EQ(result.pose->matrix(), right.pose->matrix());
    EXPECT_EQ(result.warning, std::string("the exposure that the frame tells, ") + told +
                                  ", is neither 0 nor from 1e-07 to 1 s: it counts as not told");
  }
  for (const double exposure_s : {0.0, 1.0}) {  // an instant; far too long
    BlurTracker tracker = tracker_of(film);
    for (std::size_t i = 0; i < 4; ++i) {
      frame = film.frames[i].frame();
      frame.exposure_s = exposure_s;
      const TrackResult result = tracker.track(frame, film.detections[i]);
      // A tag that is read gives its pose, whatever is said of the exposure.
      ASSERT_EQ(film.detections[i].size(), 1U);
      ASSERT_TRUE(result.pose && result.covariance) << "frame " << i << ", exposure " << exposure_s << " s";
      EXPECT_TRUE(result.pose->is_finite() && result.covariance->allFinite());
      EXPECT_LT(film.corner_error_px(i, *result.pose), 0.5) << "frame " << i << ", exposure " << exposure_s;
      EXPECT_EQ(result.warning, "");
    }
  }
}

TEST(BlurTracker, WarnsOfACameraWhoseExposureCannotBe) {
  const BlurFilm& film = waved_tag();
  Camera camera = film.scene.camera;
  camera.exposure_s = 10.0;  // milliseconds, surely
  BlurTracker tracker(camera, film.scene.map, {});
  Frame frame = film.frames[0].frame();
  EXPECT_EQ(tracker.track(frame, film.detections[0]).warning, "") << "the frame's own holds";
  frame = film.frames[1].frame();
  frame.exposure_s.reset();
  const TrackResult result = tracker.track(frame, film.detections[1]);
  EXPECT_EQ(
      result.warning,
      "the exposure that the camera tells, 10 s, is neither 0 nor from 1e-07 to 1 s: it counts as not told");
  ASSERT_TRUE(result.exposure);
  EXPECT_FALSE(result.exposure->told_s);
}

TEST(BlurTracker, KnowsAnExposureThatNobodyTells) {
  const BlurFilm& film = waved_tag();
  Camera camera = film.scene.camera;
  camera.exposure_s.reset();
  camera.width = camera.height = 0;  // the first image tells
  BlurTrackerOptions options;
  options.mode = TrackMode::kJoint;
  options.default_exposure_s = *film.scene.camera.exposure_s;
  BlurTracker tracker(camera, film.scene.map, options);
  for (std::size_t i = 0; i < film.size() / 2; ++i) {
    Frame frame = film.frames[i].frame();
    frame.exposure_s.reset();
    const TrackResult result = tracker.track(frame, film.detections[i]);
    ASSERT_TRUE(result.pose) << "frame " << i;
    EXPECT_LT(film.corner_error_px(i, *result.pose), 2.0) << "frame " << i;
  }
  const GrayImage other = grain_image(640, 480);
  Frame frame;
  frame.image = other.view();
  EXPECT_EQ(tracker.track(frame).status, TrackStatus::kLost);
}

TEST(BlurTrackerOptions, RefuseWhatIsOutOfRangeByName) {
  const auto message = [](const auto& change) {
    BlurTrackerOptions options;
    change(options);
    return message_of([&] { options.check(); });
  };
  EXPECT_NE(message([](auto& o) { o.corner_sigma_px = 0.0; }).find("corner_sigma_px"), std::string::npos);
  EXPECT_NE(message([](auto& o) { o.num_particles = 3; }).find("num_particles"), std::string::npos);
  EXPECT_NE(message([](auto& o) { o.max_prediction_s = 0.7; }).find("max_prediction_s"), std::string::npos);
  EXPECT_NE(message([](auto& o) { o.default_exposure_s = -1; }).find("default_exposure_s"),
            std::string::npos);
  EXPECT_THROW(BlurTracker(waved_tag().scene.camera, TagMap(), {}), Error);
}

}  // namespace
}  // namespace apriltrack::test
