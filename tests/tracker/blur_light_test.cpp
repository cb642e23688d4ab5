#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "apriltrack/tracker/blur_tracker.h"
#include "blur_film.h"

namespace apriltrack::test {
namespace {

/// The picture under `factor` times the light, by the inverse of the camera's response.
GrayImage dimmed(const GrayImage& image, const ResponseCurve& response, double factor) {
  const auto& light = response.linear_light();
  GrayImage result = image;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const double wanted = factor * light[image(x, y)];
      const auto above = std::lower_bound(light.begin(), light.end(), wanted);
      result(x, y) = static_cast<std::uint8_t>(above - light.begin());
    }
  }
  return result;
}

/// waved_tag() through frames that cannot be read, the first of them on at half the light; what the camera
/// tells of it. Returns the statuses of these frames.
std::vector<TrackStatus> statuses_at_half_light(double told_gain) {
  const BlurFilm& film = waved_tag();
  BlurTracker tracker = tracker_of(film);
  std::vector<TrackStatus> statuses;
  for (std::size_t i = 0; i < film.size() && statuses.size() < 3; ++i) {
    const bool is_read = !film.detections[i].empty();
    if (is_read && statuses.empty()) {
      tracker.track(film.frames[i].frame(), film.detections[i]);
      continue;
    }
    const GrayImage dim = dimmed(film.frames[i].pixels, film.scene.camera.response, 0.5);
    Frame frame = film.frames[i].frame(told_gain);
    frame.image = dim.view();
    statuses.push_back(tracker.track(frame, {}).status);
  }
  return statuses;
}

TEST(BlurTracker, FollowsThroughAStepOfTheGainThatTheCameraTells) {
  EXPECT_EQ(statuses_at_half_light(0.5), std::vector<TrackStatus>(3, TrackStatus::kTracked));
}

TEST(BlurTracker, DoubtsATagThatIsSuddenlyHalfAsLightForNoReason) {
  EXPECT_EQ(statuses_at_half_light(1.0), std::vector<TrackStatus>(3, TrackStatus::kPredicted));
}

TEST(BlurTracker, FollowsThroughAStepOfTheExposureThatAnUnknownGainMakesUpFor) {
  // As a camera does that tells the exposures of its frames, and not their gain: the picture stays as light.
  const BlurFilm& film = waved_tag();
  BlurTracker tracker = tracker_of(film);
  int num_unread = 0;
  for (std::size_t i = 0; i < film.size() && num_unread < 3; ++i) {
    Frame frame = film.frames[i].frame(film.detections[i].empty() ? 2.0 : 1.0);
    const TrackResult result = tracker.track(frame, film.detections[i]);
    if (!film.detections[i].empty()) continue;
    EXPECT_EQ(result.status, TrackStatus::kTracked) << "frame " << i;
    ++num_unread;
  }
  EXPECT_EQ(num_unread, 3);
}

}  // namespace
}  // namespace apriltrack::test
