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

struct DimFrame {
  TrackStatus status;
  double turn_rad;  ///< Of the tag, since it was seen last in full light.
};

/// waved_tag() through three frames that cannot be read, at `factor` times the light; what the camera tells
/// of it.
std::vector<DimFrame> dim_frames(double factor, double told_gain) {
  const BlurFilm& film = waved_tag();
  BlurTracker tracker = tracker_of(film);
  std::vector<DimFrame> dim;
  std::size_t last_read = 0;
  for (std::size_t i = 0; i < film.size() && dim.size() < 3; ++i) {
    const bool is_read = !film.detections[i].empty();
    if (is_read && dim.empty()) {
      tracker.track(film.frames[i].frame(), film.detections[i]);
      last_read = i;
      continue;
    }
    const GrayImage image = dimmed(film.frames[i].pixels, film.scene.camera.response, factor);
    Frame frame = film.frames[i].frame(told_gain);
    frame.image = image.view();
    const double turn_rad =
        film.frames[i].truth.rotation().angularDistance(film.frames[last_read].truth.rotation());
    dim.push_back({tracker.track(frame, {}).status, turn_rad});
  }
  return dim;
}

TEST(BlurTracker, FollowsThroughAStepOfTheGainThatTheCameraTells) {
  const std::vector<DimFrame> dim = dim_frames(0.5, 0.5);
  ASSERT_EQ(dim.size(), 3U);
  for (const DimFrame& frame : dim) EXPECT_EQ(frame.status, TrackStatus::kTracked);
}

/// A tag that has turned by as much as makes up for half of the light may be as it was.
TEST(BlurTracker, DoubtsATagThatIsSuddenlyHalfAsLightForNoReason) {
  const double turn_that_explains_rad = std::log(2.0 / 1.4);
  constexpr double kMargin_rad = 0.03;  // contrast is measured within 3 %
  const std::vector<DimFrame> dim = dim_frames(0.5, 1.0);
  ASSERT_EQ(dim.size(), 3U);
  EXPECT_LT(dim.front().turn_rad, turn_that_explains_rad - kMargin_rad);
  for (const DimFrame& frame : dim) {
    if (frame.turn_rad > turn_that_explains_rad - kMargin_rad) continue;
    EXPECT_EQ(frame.status, TrackStatus::kPredicted) << frame.turn_rad;
  }
}

TEST(BlurTracker, DoubtsATagThatIsSuddenlyAQuarterAsLightHoweverItTurns) {
  const std::vector<DimFrame> dim = dim_frames(0.25, 1.0);
  ASSERT_EQ(dim.size(), 3U);
  for (const DimFrame& frame : dim) EXPECT_EQ(frame.status, TrackStatus::kPredicted) << frame.turn_rad;
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
