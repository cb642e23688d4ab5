#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "apriltrack/tracker/blur_tracker.h"
#include "blur_film.h"

namespace apriltrack::test {
namespace {

/// The tag of still_tag() this far aside, at rest or on its way down through the middle.
BlurFilm tag_at(double x_m, double speed_down_m_per_s, std::size_t num_frames) {
  Scene scene = still_tag().scene;
  std::array<Channel, 3>& position_m = scene.bodies[0].T_world_body.position_m;
  position_m[0].offset = x_m;
  position_m[1].rate_per_s = speed_down_m_per_s;
  position_m[1].offset = -speed_down_m_per_s * 1e-9 * static_cast<double>(scene.start_ns);
  scene.num_frames = num_frames;
  return {scene, 1};
}

/// A tag at rest in the left half of the image, until something hits it: three frames later it falls through
/// the right half. A worn copy of it hangs where it was.
class TagThatWasHit : public ::testing::Test {
 protected:
  /// So far aside that the motion so far allows the place, but not the fall as well.
  static constexpr double kAside_m = 0.14, kFall_m_per_s = 3.0;
  static constexpr std::int64_t kGap_ns = 99'000'000;

  TagThatWasHit() : image_(hit_.frames[0].pixels) {
    const GrayImage& copy = at_rest_.frames[0].pixels;
    for (int y = 0; y < image_.height(); ++y) {
      for (int x = 0; x < image_.width() / 2; ++x) image_(x, y) = copy(x, y);
    }
    wear(at_rest_.detections[0].at(0));
  }

  /// Grey from the top of the tag to its bottom.
  void wear(const Detection& tag) {
    constexpr int kWidth_px = 16;
    const auto& corners = tag.corners_px;
    const Eigen::Vector2d middle = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
    const int left = static_cast<int>(middle.x()) - 12, top = static_cast<int>(middle.y()) - 30;
    for (int y = top; y < top + 60; ++y) {
      for (int x = left; x < left + kWidth_px; ++x) image_(x, y) = 120;
    }
  }
  TrackResult tracked_when_hit(BlurTracker& tracker, std::optional<int> corrected_bits) const {
    for (std::size_t i = 0; i < at_rest_.size(); ++i)
      EXPECT_EQ(tracker.track(at_rest_.frames[i].frame(), at_rest_.detections[i]).status,
                TrackStatus::kDetected);
    Frame frame = hit_.frames[0].frame();
    frame.image = image_.view();
    frame.timestamp.ns = at_rest_.frames.back().timestamp.ns + kGap_ns;
    std::vector<Detection> detections = hit_.detections[0];
    detections.at(0).hamming = corrected_bits;
    return tracker.track(frame, detections);
  }

  const BlurFilm at_rest_ = tag_at(-kAside_m, 0.0, 8), hit_ = tag_at(kAside_m, kFall_m_per_s, 1);
  GrayImage image_;
};

TEST_F(TagThatWasHit, IsNotClaimedWhereTheMotionExpectedIt) {
  // The copy would convince, where the motion expects the tag; but another place, which the motion rules out,
  // shows the tag far better. A reading with a corrected bit does not settle it.
  BlurTracker tracker = tracker_of(at_rest_);
  const TrackResult result = tracked_when_hit(tracker, 1);
  EXPECT_EQ(result.status, TrackStatus::kPredicted);
}

TEST_F(TagThatWasHit, IsClaimedWhereItIsOnceItIsReadForSure) {
  BlurTracker tracker = tracker_of(at_rest_);
  const TrackResult result = tracked_when_hit(tracker, 0);
  EXPECT_EQ(result.status, TrackStatus::kDetected);
  ASSERT_TRUE(result.pose);
  EXPECT_LT(hit_.corner_error_px(0, *result.pose), 1.0);
}

}  // namespace
}  // namespace apriltrack::test
